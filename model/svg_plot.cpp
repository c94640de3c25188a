#include "model/svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fogbench::model {
namespace {

// The plot's own coordinates; the page scales it to the width it has.
constexpr double kWidth = 560.0, kHeight = 320.0;
constexpr double kLeft = 70.0, kRight = 16.0, kTop = 34.0, kBottom = 50.0;

/// One axis: data to the plot's coordinates.
struct Axis {
  double low, high, start, end;
  double operator()(double value) const {
    return start + (value - low) / (high - low) * (end - start);
  }
};

Axis make_axis(double low, double high, double start, double end) {
  if (!(low < high)) {
    const double half = std::max(std::abs(low) * 0.05, 1e-6);
    low -= half;
    high += half;
  }
  const double margin = 0.04 * (high - low);
  return {low - margin, high + margin, start, end};
}

std::string tick_text(double value, double span) {
  if (std::abs(value) < 1e-9 * span) value = 0.0;
  return fmt::format("{:.6g}", value);
}

}  // namespace

std::vector<double> round_ticks(double low, double high) {
  const double raw = (high - low) / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double part = raw / power;
  const double step = power * (part < 1.5 ? 1.0 : part < 3.5 ? 2.0 : part < 7.5 ? 5.0 : 10.0);
  std::vector<double> out;
  for (double k = std::ceil(low / step); k * step <= high; k += 1.0) out.push_back(k * step);
  return out;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string SvgPlot::svg() const {
  double x_low = INFINITY, x_high = -INFINITY, y_low = INFINITY, y_high = -INFINITY;
  for (const auto& [x, y] : points) {
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    x_low = std::min(x_low, x);
    x_high = std::max(x_high, x);
    y_low = std::min(y_low, y);
    y_high = std::max(y_high, y);
  }
  if (!(x_low <= x_high)) return "";
  if (zero_line) {
    y_low = std::min(y_low, -envelope);
    y_high = std::max(y_high, envelope);
  }
  if (diagonal) {
    x_low = y_low = std::min(x_low, y_low);
    x_high = y_high = std::max(x_high, y_high);
  }
  const Axis x_axis = make_axis(x_low, x_high, kLeft, kWidth - kRight);
  const Axis y_axis = make_axis(y_low, y_high, kHeight - kBottom, kTop);
  std::string out =
      fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">\n", kWidth,
                  kHeight, escaped(title));
  const auto line = [&](const char* kind, double x1, double y1, double x2, double y2) {
    out += fmt::format(
        "<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", kind, x1,
        y1, x2, y2);
  };
  const auto text = [&](const char* kind, double x, double y, const std::string& words) {
    out += fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", kind, x, y,
                       escaped(words));
  };
  for (const Band& band : bands) {
    const double from = std::max(x_axis(band.from) - 5.0, kLeft);
    const double to = std::min(x_axis(band.to) + 5.0, kWidth - kRight);
    if (!(to > from)) continue;
    out += fmt::format(
        "<rect class=\"band\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\">"
        "<title>{}</title></rect>\n",
        from, kTop, to - from, kHeight - kBottom - kTop, escaped(band.title));
  }
  const std::vector<double> x_ticks = round_ticks(x_axis.low, x_axis.high);
  const std::vector<double> y_ticks = round_ticks(y_axis.low, y_axis.high);
  for (double tick : x_ticks) {
    line("grid", x_axis(tick), kTop, x_axis(tick), kHeight - kBottom);
    text("tick middle", x_axis(tick), kHeight - kBottom + 16.0,
         tick_text(tick, x_axis.high - x_axis.low));
  }
  for (double tick : y_ticks) {
    line("grid", kLeft, y_axis(tick), kWidth - kRight, y_axis(tick));
    text("tick end", kLeft - 6.0, y_axis(tick) + 4.0, tick_text(tick, y_axis.high - y_axis.low));
  }
  if (diagonal) {
    line("model", x_axis(x_axis.low), y_axis(x_axis.low), x_axis(x_axis.high), y_axis(x_axis.high));
  }
  if (zero_line) line("model", kLeft, y_axis(0.0), kWidth - kRight, y_axis(0.0));
  if (envelope > 0.0) {
    for (double y : {-envelope, envelope})
      line("noise", kLeft, y_axis(y), kWidth - kRight, y_axis(y));
  }
  const double radius = points.size() <= 100 ? 3.5 : points.size() <= 500 ? 2.5 : 1.5;
  for (const auto& [x, y] : points) {
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/>\n", x_axis(x), y_axis(y),
                       radius);
  }
  text("title", kLeft, 20.0, title);
  text("label middle", 0.5 * (kLeft + kWidth - kRight), kHeight - 12.0, x_label);
  out += fmt::format(
      "<text class=\"label middle\" transform=\"translate(16 {:.1f}) rotate(-90)\">{}</text>\n",
      0.5 * (kTop + kHeight - kBottom), escaped(y_label));
  return out + "</svg>\n";
}

}  // namespace fogbench::model
