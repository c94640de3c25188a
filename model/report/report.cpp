#include "model/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "config/rounding.hpp"
#include "config/units.hpp"
#include "model/report/report_page.hpp"
#include "model/report/report_plots.hpp"
#include "model/report/svg_plot.hpp"

namespace fogbench::model {
namespace {

constexpr std::size_t kMostRanges = 24;

std::string regions_table(const Comparison& c, std::string_view unit) {
  std::string out = fmt::format(
      "<div class=\"wide\"><table><tr><th></th><th "
      "class=\"text\">range</th><th>rows</th><th>measured, {0}</th>"
      "<th>model, {0}</th><th>residual, {0}</th><th>less slow drift, {0}</th><th>z</th><th>p, of "
      "all "
      "ranges</th></tr>\n",
      unit);
  for (std::size_t i = 0; i < std::min(c.regions.size(), kMostRanges); ++i) {
    const Region& r = c.regions[i];
    if (c.noise_known && r.z == 0.0) break;  // the fit leaves it and all after it no freedom
    const bool fails = c.noise_known && r.p_family_wise < kAdequate;
    out += fmt::format(
        "<tr{}><td>{}</td><td "
        "class=\"text\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</"
        "td><td>{}</td>"
        "<td>{}</td></tr>\n",
        fails ? " class=\"fails\"" : "", i + 1, escaped(place_of(r)), r.rows,
        config::significant(r.observed, 4), config::significant(r.observed - r.residual, 4),
        number_text(r.residual), number_text(r.offset),
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
  const PlottedFits fits{
      .table = table, .model = model, .comparison = c, .noise_floor = c.noise_floor};
  std::string out = page_start(fmt::format("{} against {}", model.name, data_name));
  out += fmt::format(
      "<h1>{} against the measurements</h1>\n<p class=\"sub\">{} &middot; {} rows "
      "&middot; {}</p>\n",
      escaped(model.name), escaped(data_name), c.fit.rows.size(),
      c.as_is ? "coefficients held as given" : "coefficients fitted");
  out += provenance_text(table);
  out += fmt::format("<div class=\"verdict{}\">\n", fails ? " fails" : "");
  for (const std::string& sentence : c.sentences) {
    out += fmt::format("<p{}>{}</p>\n", &sentence == &c.sentences.front() ? " class=\"lead\"" : "",
                       escaped(sentence));
  }
  for (const std::string& warning : c.fit.warnings) {
    out += fmt::format("<p>Warning: {}</p>\n", escaped(warning));
  }
  out += "</div>\n<h2>Where they differ</h2>\n" + plot_legend(fits) + "<div class=\"plots\">\n" +
         measured_against_model(fits) + residual_plots(fits) + "</div>\n";
  const std::string loops = loop_plots(fits);
  if (!loops.empty()) {
    out += "<h2>Loops of the residual, up and down</h2>\n" + loop_legend(fits) +
           "<div class=\"plots\">\n" + loops + "</div>\n";
  }
  out += "<h2>Coefficients</h2>\n" + estimates_table(c.fit.estimates);
  if (!c.regions.empty()) out += "<h2>Ranges, worst first</h2>\n" + regions_table(c, unit);
  return out + page_end(rows_json(fits));
}

}  // namespace fogbench::model
