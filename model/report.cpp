#include "model/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "config/units.hpp"
#include "model/partition.hpp"
#include "model/svg_plot.hpp"

namespace fogbench::model {
namespace {

constexpr std::size_t kMostPoints = 2000;
constexpr std::size_t kMostRanges = 24;

// Ink on paper: readable in black and white, one warm colour for what fails.
constexpr auto kStyle = R"(
:root { --ink: #1c2126; --soft: #5d6670; --rule: #d9dde1; --point: #23618e; --fail: #b3401f; }
* { box-sizing: border-box; }
body { font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; color: var(--ink); background: #fff;
       margin: 0 auto; max-width: 74rem; padding: 1.5rem 1.25rem 4rem; }
h1 { font-size: 1.5rem; margin: 0 0 .25rem; line-height: 1.25; }
h2 { font-size: 1.1rem; margin: 2.25rem 0 .75rem; }
.sub { color: var(--soft); margin: 0 0 1.25rem; overflow-wrap: anywhere; }
.verdict { border-left: .3rem solid var(--point); padding: .1rem 0 .1rem 1rem; max-width: 46rem; }
.verdict.fails { border-color: var(--fail); }
.verdict p { margin: .5rem 0; }
.plots { display: grid; gap: 1.25rem; grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); }
svg { width: 100%; height: auto; display: block; break-inside: avoid; }
svg text { font: 12px system-ui, "DejaVu Sans", sans-serif; fill: var(--soft); }
svg .title { font-size: 13.5px; font-weight: 600; fill: var(--ink); }
svg .middle { text-anchor: middle; } svg .end { text-anchor: end; }
svg .grid { stroke: var(--rule); } svg .model { stroke: var(--ink); stroke-width: 1.2; }
svg .noise { stroke: var(--soft); stroke-dasharray: 5 4; }
svg circle { fill: var(--point); fill-opacity: .75; }
svg .band { fill: var(--fail); fill-opacity: .16; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem .9rem .3rem 0; text-align: right; border-bottom: 1px solid var(--rule);
         white-space: nowrap; }
th { font-weight: 600; color: var(--soft); }
th:first-child, td:first-child, td.text { text-align: left; }
tr.fails td { color: var(--fail); font-weight: 600; }
@media print { body { max-width: none; padding: 0; font-size: 11pt; } h2 { break-after: avoid; }
               .plots { grid-template-columns: 1fr 1fr; } tr { break-inside: avoid; } }
)";

std::string heading_of(const std::string& variable) {
  if (variable == "time_s") return "time, h";
  std::string words = variable;
  const std::string_view unit = config::unit_of(variable);
  for (const config::UnitSuffix& suffix : config::kUnitSuffixes) {
    if (!variable.ends_with(suffix.suffix)) continue;
    words = variable.substr(0, variable.size() - suffix.suffix.size());
    break;
  }
  std::replace(words.begin(), words.end(), '_', ' ');
  return unit.empty() ? words : fmt::format("{}, {}", words, unit);
}

/// Every so many-th row, so that no plot holds more than kMostPoints.
std::size_t stride_of(const Comparison& c) {
  return c.fit.rows.size() / kMostPoints + 1;
}

std::string measured_against_model(const Comparison& c, std::string_view unit) {
  SvgPlot plot{.title = "Measured against model",
               .x_label = fmt::format("model, {}", unit),
               .y_label = fmt::format("measured, {}", unit),
               .diagonal = true};
  for (std::size_t i = 0; i < c.fit.rows.size(); i += stride_of(c)) {
    const auto row = static_cast<Eigen::Index>(i);
    plot.points.emplace_back(c.fit.predicted[row], c.fit.predicted[row] + c.fit.residual[row]);
  }
  return plot.svg();
}

/// The residual by each variable of the table that was cut into ranges, failing ranges marked.
std::string residual_plots(const Comparison& c, const Table& table, std::string_view unit) {
  std::vector<std::string> variables;
  for (const Region& region : c.regions) {
    const bool known =
        std::find(variables.begin(), variables.end(), region.variable) != variables.end();
    if (!known && table.has(region.variable)) variables.push_back(region.variable);
  }
  std::string out;
  for (const std::string& variable : variables) {
    const double scale = variable == "time_s" ? 3600.0 : 1.0;
    SvgPlot plot{.title = fmt::format("Residual by {}", heading_of(variable)),
                 .x_label = heading_of(variable),
                 .y_label = fmt::format("measured - model, {}", unit),
                 .zero_line = true,
                 .envelope = std::isfinite(c.noise_floor) ? 2.0 * c.noise_floor : 0.0};
    const std::span<const double> values = table.column(variable);
    for (std::size_t i = 0; i < c.fit.rows.size(); i += stride_of(c)) {
      plot.points.emplace_back(values[c.fit.rows[i]] / scale,
                               c.fit.residual[static_cast<Eigen::Index>(i)]);
    }
    for (const Region& region : c.regions) {
      if (region.variable != variable || !c.noise_known) continue;
      if (region.p_family_wise >= kAdequate) continue;
      plot.bands.push_back({region.from / scale, region.to / scale, region.says});
    }
    out += plot.svg();
  }
  return out;
}

std::string estimates_table(const Comparison& c) {
  std::string out =
      "<div class=\"wide\"><table><tr><th>term</th><th>estimate</th><th>&plusmn; (95.45 %)</th>"
      "<th>unit</th></tr>\n";
  for (const Estimate& e : c.fit.estimates) {
    const double expanded = e.coverage_factor * e.standard_error;
    out += fmt::format("<tr><td>{}</td><td>{:.6g}</td><td>{}</td><td class=\"text\">{}</td></tr>\n",
                       escaped(e.name), e.value,
                       e.held                 ? "held"
                       : std::isnan(expanded) ? "unknown"
                                              : fmt::format("{:.2g}", expanded),
                       escaped(e.unit));
  }
  return out + "</table></div>\n";
}

std::string regions_table(const Comparison& c, std::string_view unit) {
  std::string out = fmt::format(
      "<div class=\"wide\"><table><tr><th>range</th><th>rows</th><th>measured, {0}</th>"
      "<th>model, {0}</th><th>residual, {0}</th><th>slow drift apart, {0}</th><th>z</th><th>p, of "
      "all "
      "ranges</th></tr>\n",
      unit);
  for (std::size_t i = 0; i < std::min(c.regions.size(), kMostRanges); ++i) {
    const Region& r = c.regions[i];
    if (c.noise_known && r.z == 0.0) break;  // the fit leaves it and all after it no freedom
    const bool fails = c.noise_known && r.p_family_wise < kAdequate;
    out += fmt::format(
        "<tr{}><td>{}</td><td>{}</td><td>{:.4g}</td><td>{:.4g}</td><td>{:.3g}</td><td>{:.3g}</"
        "td><td>{}</td>"
        "<td>{}</td></tr>\n",
        fails ? " class=\"fails\"" : "", escaped(place_of(r)), r.rows, r.observed,
        r.observed - r.residual, r.residual, r.offset,
        c.noise_known ? fmt::format("{:.1f}", r.z) : "",
        c.noise_known ? fmt::format("{:.2g}", r.p_family_wise) : "");
  }
  return out + "</table></div>\n";
}

}  // namespace

std::string report_html(const Comparison& c, const Table& table, const config::ModelFile& model,
                        const std::string& data_name) {
  const std::string_view unit = config::unit_of(model.observable);
  const bool fails = c.noise_known && c.p_adequate < kAdequate;
  std::string out = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0} against {1}</title>\n<style>{2}</style>\n</head>\n<body>\n"
      "<h1>{0} against the measurements</h1>\n<p class=\"sub\">{1} &middot; {3} rows &middot; "
      "{4}</p>\n",
      escaped(model.name), escaped(data_name), kStyle, c.fit.rows.size(),
      c.as_is ? "coefficients held as given" : "coefficients fitted");
  out += fmt::format("<div class=\"verdict{}\">\n", fails ? " fails" : "");
  for (const std::string& sentence : c.sentences) {
    out += fmt::format("<p>{}</p>\n", escaped(sentence));
  }
  for (const std::string& warning : c.fit.warnings) {
    out += fmt::format("<p>Warning: {}</p>\n", escaped(warning));
  }
  out += "</div>\n<h2>Where they differ</h2>\n<div class=\"plots\">\n";
  out += measured_against_model(c, unit) + residual_plots(c, table, unit) + "</div>\n";
  if (fails) out += "<p class=\"sub\">Shaded: ranges where the model fails by more than noise.";
  if (fails && std::isfinite(c.noise_floor)) out += " Dashed: twice the noise.";
  if (fails) out += "</p>\n";
  out += "<h2>Coefficients</h2>\n" + estimates_table(c);
  if (!c.regions.empty()) out += "<h2>Ranges, worst first</h2>\n" + regions_table(c, unit);
  return out + "</body>\n</html>\n";
}

}  // namespace fogbench::model
