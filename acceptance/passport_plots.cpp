#include "acceptance/passport_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "model/report/svg_plot.hpp"

namespace fogbench::acceptance {
using model::SvgPlot;

namespace {

/// Test after test; the page's style has the colours of .first and .second.
constexpr std::array<const char*, 2> kSeries{"first", "second"};
constexpr std::array<SvgPlot::Mark, 2> kMarks{SvgPlot::Mark::kDot, SvgPlot::Mark::kSquare};

using XY = std::vector<std::pair<double, double>>;

double coefficient_of(const TestResults& test, const std::string& name) {
  if (!test.fit) return std::nan("");
  for (const model::Estimate& e : test.fit->estimates) {
    if (e.name == name) return e.value;
  }
  return std::nan("");
}

/// `shape` over the range of the measurements, moved to their mean.
XY line_through(const XY& measured, const std::function<double(double)>& shape) {
  if (measured.empty()) return {};
  const auto by_x = [](const auto& a, const auto& b) { return a.first < b.first; };
  const auto [low, high] = std::minmax_element(measured.begin(), measured.end(), by_x);
  double shift = 0.0;
  for (const auto& [x, y] : measured)
    shift += (y - shape(x)) / static_cast<double>(measured.size());
  XY line;
  constexpr int kParts = 40;
  for (int i = 0; i <= kParts; ++i) {
    const double x = low->first + (high->first - low->first) * i / kParts;
    line.emplace_back(x, shape(x) + shift);
  }
  return line;
}

/// Marks and line of one test; its place among the tests that are drawn decides how they look.
void add_test(SvgPlot& plot, XY measured, const std::function<double(double)>& shape,
              std::size_t place) {
  const std::string kind = kSeries[place % kSeries.size()];
  XY line = line_through(measured, shape);
  plot.series.push_back({.kind = kind,
                         .mark = kMarks[place % kMarks.size()],
                         .points = std::move(measured),
                         .rows = {}});
  // The square is a mark that the style can hide.
  plot.series.push_back({.kind = kind + " line",
                         .mark = SvgPlot::Mark::kSquare,
                         .joined = true,
                         .points = std::move(line),
                         .rows = {}});
}

SvgPlot temperature_plot(const Acceptance& acceptance, Language language) {
  SvgPlot plot{.title = std::string(text(Text::kByTemperature, language)),
               .x_label = std::string(text(Text::kTemperatureAxis, language)),
               .y_label = std::string(text(Text::kDeviationAxis, language))};
  for (std::size_t i = 0; i < acceptance.tests.size(); ++i) {
    const TestResults& test = acceptance.tests[i];
    XY measured;
    for (const SetPoint& row : test.set_points) {
      measured.emplace_back(row.temperature_c, row.deviation_deg_per_h.value);
    }
    const double linear = coefficient_of(test, "temperature_linear");
    const double quadratic = coefficient_of(test, "temperature_quadratic");
    const double reference = test.fit ? test.fit->fitted.reference_temperature_c : 0.0;
    add_test(
        plot, std::move(measured),
        [=](double t) {
          return linear * (t - reference) + quadratic * (t - reference) * (t - reference);
        },
        i);
  }
  return plot;
}

SvgPlot field_plot(const Acceptance& acceptance, char axis, Language language) {
  const std::string name = fmt::format("O{}", static_cast<char>(axis - 'x' + 'X'));
  SvgPlot plot{.title = fmt::format(fmt::runtime(text(Text::kByField, language)), name),
               .x_label = std::string(text(Text::kFieldAxis, language)),
               .y_label = std::string(text(Text::kDeviationAxis, language))};
  for (std::size_t i = 0; i < acceptance.tests.size(); ++i) {
    const TestResults& test = acceptance.tests[i];
    XY measured;
    for (const SweepResult& sweep : test.results.sweeps) {
      if (sweep.axis != axis) continue;
      for (const Deviation& row : test.results.magnetic) {
        const bool of_sweep = row.segment.substr(0, row.segment.find('/')) == sweep.sweep;
        if (of_sweep) measured.emplace_back(row.field_ut, row.deviation_deg_per_h.value);
      }
      break;
    }
    const double slope = coefficient_of(test, fmt::format("magnetic_linear_{}", axis)) / 100.0;
    add_test(
        plot, std::move(measured), [slope](double field) { return slope * field; }, i);
  }
  return plot;
}

std::string legend(const Acceptance& acceptance, Language language) {
  constexpr std::array kPictures{
      R"(<path class="joint first line" d="M0 7H28"/><path class="dots first" stroke-width="7" d="M14 7h0"/>)",
      R"(<path class="joint second line" d="M0 7H28"/><path class="marks second" d="M11 4h7v7h-7z"/>)"};
  std::string out = "<ul class=\"legend\">\n";
  for (std::size_t i = 0; i < acceptance.tests.size(); ++i) {
    out += fmt::format("<li><svg viewBox=\"0 0 28 14\">{}</svg>{}</li>\n",
                       kPictures[i % kPictures.size()],
                       fmt::format(fmt::runtime(text(Text::kMarksOfTest, language)),
                                   model::escaped(acceptance.tests[i].name)));
  }
  return out + "</ul>\n";
}

}  // namespace

std::string passport_plots(const Acceptance& acceptance, Language language) {
  std::string figures;
  const auto add = [&](SvgPlot plot) {
    plot.decimal_comma = text(Text::kDecimalMark, language) == ",";
    const std::string svg = plot.svg();
    if (!svg.empty()) figures += "<figure>" + svg + "</figure>\n";
  };
  add(temperature_plot(acceptance, language));
  for (const char axis : {'x', 'y', 'z'}) add(field_plot(acceptance, axis, language));
  if (figures.empty()) return "";
  return legend(acceptance, language) + "<div class=\"plots\">\n" + figures + "</div>\n";
}

}  // namespace fogbench::acceptance
