#include "model/report/diagnosis_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "config/rounding.hpp"
#include "model/diagnose/verdict_text.hpp"
#include "model/effects/catalogue.hpp"
#include "model/report/report_page.hpp"
#include "model/report/report_plots.hpp"
#include "model/report/svg_plot.hpp"

namespace fogbench::model {
namespace {

constexpr std::size_t kMostFailures = 24;

/// A bar over `share` of its cell's width.
std::string bar(std::string_view kind, double share) {
  return fmt::format("<span class=\"bar {}\" style=\"width:{:.1f}%\"></span>", kind,
                     100.0 * std::clamp(std::isfinite(share) ? share : 0.0, 0.0, 1.0));
}

/// Of a catalogue effect; a user's candidate and changes between runs have none.
std::string formula_of(const std::string& effect) {
  const Effect* known = find_effect(effect);
  return known ? escaped(std::string(known->info().formula)) : "";
}

std::string escaped_list(const std::vector<std::string>& items) {
  return escaped(fmt::format("{}", fmt::join(items, ", ")));
}

std::string coefficient_row(std::string_view name, double value, std::string_view unit) {
  return fmt::format("<tr><td>{}</td><td>{}</td><td class=\"text\">{}</td></tr>\n", name,
                     value > 0.0 ? fmt::format("{:.3g}", value) : "not seen", unit);
}

}  // namespace

std::string p_text(double p) {
  // Fewer worlds were simulated than a smaller number would need.
  return p < 1e-4 ? "&lt; 0.0001" : fmt::format("{:.2g}", p);
}

std::string ladder_section(const Diagnosis& d, std::string_view unit) {
  if (d.ladder.empty()) return "";
  double largest = std::isfinite(d.noise_floor) ? d.noise_floor : 0.0;
  for (const LadderStep& step : d.ladder) {
    for (double rms : {step.rms, step.heldout_rms}) {
      if (std::isfinite(rms)) largest = std::max(largest, rms);
    }
  }
  const double scale = largest > 0.0 ? 1.0 / largest : 0.0;
  const bool floor_known = std::isfinite(d.noise_floor);
  std::string out = fmt::format(
      "<h2>{2}</h2>\n<ul class=\"legend\">\n"
      "<li><span class=\"bar fitted key\"></span>RMS residual of the fit</li>\n"
      "<li><span class=\"bar heldout key\"></span>RMS on rows held out of the fit</li>\n{1}</ul>\n"
      "<table class=\"ladder\"><tr><th>model</th><th>RMS{0}</th><th>held out{0}</th>"
      "<th class=\"bars\"></th></tr>\n",
      with_unit(unit),
      floor_known ? "<li><span class=\"bar floor key\"></span>what noise alone would leave</li>\n"
                  : "",
      d.ladder.size() > 1 ? "The error as effects are added" : "The error");
  for (const LadderStep& step : d.ladder) {
    out += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"bars\">{}{}</td></tr>\n",
                       step.added.empty() ? "as it came" : "+ " + escaped(step.added),
                       number_text(step.rms), number_text(step.heldout_rms),
                       bar("fitted", step.rms * scale), bar("heldout", step.heldout_rms * scale));
  }
  if (floor_known) {
    out +=
        fmt::format("<tr><td>noise alone</td><td>{}</td><td></td><td class=\"bars\">{}</td></tr>\n",
                    number_text(d.noise_floor), bar("floor", d.noise_floor * scale));
  }
  return out + "</table>\n";
}

std::string ranking_section(const Diagnosis& d) {
  if (d.missing.empty()) return "";
  std::string out =
      "<h2>What was found, and what competed with it</h2>\n<div class=\"wide\">"
      "<table class=\"ranking\"><tr><th>effect</th><th class=\"text\">formula</th>"
      "<th>p</th><th>probability</th><th class=\"bars\"></th></tr>\n";
  std::string notes;
  for (const MissingEffect& missing : d.missing) {
    const Found& found = missing.found;
    const std::string id = escaped(found.effect);
    out += fmt::format(
        "<tr class=\"added\"><td>{}</td><td class=\"text\">{}</td><td>{}</td><td>{} %</td>"
        "<td class=\"bars\">{}</td></tr>\n",
        id, formula_of(found.effect), p_text(found.p_value),
        config::significant(100.0 * found.probability, 2), bar("fitted", found.probability));
    for (const Rival& rival : found.rivals) {
      out += fmt::format(
          "<tr><td>or {}</td><td class=\"text\">{}</td><td></td><td>{} %</td>"
          "<td class=\"bars\">{}</td></tr>\n",
          escaped(rival.effect), formula_of(rival.effect),
          config::significant(100.0 * rival.probability, 2), bar("heldout", rival.probability));
    }
    if (found.inner_at_edge) {
      notes += fmt::format(
          "<li>The inner parameter of {} lies on the edge of its range: these "
          "data do not identify it.</li>\n",
          id);
    }
  }
  out += "</table></div>\n";
  return notes.empty() ? out : out + "<ul>\n" + notes + "</ul>\n";
}

std::string failures_section(const Diagnosis& d) {
  const std::vector<const Region*> failing = failing_regions(d.before);
  if (failing.empty()) return "";
  std::string out = "<h2>Where the model as it came fails</h2>\n<ol>\n";
  for (std::size_t k = 0; k < failing.size(); ++k) {
    if (k == kMostFailures) {
      out += fmt::format(
          "</ol>\n<details><summary>and {} more, all less far off</summary>\n"
          "<ol start=\"{}\">\n",
          failing.size() - k, k + 1);
    }
    out += fmt::format("<li>{}</li>\n", escaped(failing[k]->says));
  }
  return out + (failing.size() > kMostFailures ? "</ol>\n</details>\n" : "</ol>\n");
}

std::string parameters_section(const Diagnosis& d) {
  std::vector<std::string> added;
  for (const MissingEffect& missing : d.missing) {
    for (const Estimate& e : missing.estimates) added.push_back(e.name);
  }
  return "<h2>Coefficients</h2>\n" + estimates_table(d.after.estimates, added);
}

std::string noise_section(const Diagnosis& d) {
  std::string out = "<h2>Noise</h2>\n";
  if (!d.after.noise.says.empty()) {
    out += fmt::format("<p>With the last fit: {}.</p>\n", escaped(d.after.noise.says));
  }
  const NoiseCoefficients& noise = d.noise;
  const bool any = noise.angle_random_walk_deg_per_sqrt_h > 0.0 ||
                   noise.bias_instability_deg_per_h > 0.0 ||
                   noise.rate_random_walk_deg_per_h_per_sqrt_h > 0.0;
  if (!any) return d.after.noise.says.empty() ? "" : out;  // independent noise has no such numbers
  out +=
      "<div class=\"wide\"><table><tr><th>noise</th><th>most likely</th><th "
      "class=\"text\">unit</th></tr>\n";
  out += coefficient_row("N, angle random walk", noise.angle_random_walk_deg_per_sqrt_h,
                         "deg/sqrt(h)");
  out += coefficient_row("B, bias instability", noise.bias_instability_deg_per_h, "deg/h");
  out += coefficient_row("K, rate random walk", noise.rate_random_walk_deg_per_h_per_sqrt_h,
                         "deg/h/sqrt(h)");
  return out + "</table></div>\n";
}

std::string bounds_section(const Diagnosis& d) {
  if (d.bounds.empty()) return "";
  std::string out =
      "<h2>Looked for and not found</h2>\n<p class=\"sub\">Each is absent, or its coefficient is "
      "below the bound (95 %).</p>\n<div class=\"wide\"><table><tr><th>effect</th>"
      "<th>absent or below</th><th class=\"text\">unit</th></tr>\n";
  for (const Bound& bound : d.bounds) {
    out +=
        fmt::format("<tr><td>{}</td><td>{}</td><td class=\"text\">{}</td></tr>\n",
                    escaped(bound.effect), number_text(bound.absent_or_below), escaped(bound.unit));
  }
  return out + "</table></div>\n";
}

std::string not_testable_section(const Diagnosis& d) {
  if (d.not_testable.empty()) return "";
  // One line for all effects that one reason keeps out, in the order of the first.
  std::vector<std::pair<std::string, std::vector<std::string>>> reasons;
  for (const NotTestable& effect : d.not_testable) {
    auto at = std::find_if(reasons.begin(), reasons.end(),
                           [&](const auto& reason) { return reason.first == effect.because; });
    if (at == reasons.end()) at = reasons.insert(at, {effect.because, {}});
    at->second.push_back(effect.effect);
  }
  std::string out = "<h2>What these data cannot test</h2>\n<ul>\n";
  for (const auto& [because, effects] : reasons) {
    out += fmt::format("<li>{}: {}.</li>\n", escaped_list(effects), escaped(because));
  }
  return out + "</ul>\n";
}

std::string next_section(const Diagnosis& d) {
  std::string items;
  for (const NextMeasurement& next : d.next_measurements) {
    if (&next == proposed_measurement(d)) continue;  // said first of all
    items += fmt::format("<li>{}.{}</li>\n", escaped(next.action),
                         next.tells_apart.empty()
                             ? ""
                             : fmt::format(" <span class=\"soft\">Shows: {}.</span>",
                                           escaped_list(next.tells_apart)));
  }
  return items.empty() ? "" : "<h2>What else to measure</h2>\n<ul>\n" + items + "</ul>\n";
}

}  // namespace fogbench::model
