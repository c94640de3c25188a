#include "model/report/diagnosis_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "config/units.hpp"
#include "model/report/diagnosis_tables.hpp"
#include "model/report/report_page.hpp"
#include "model/report/report_plots.hpp"
#include "model/report/svg_plot.hpp"

namespace fogbench::model {
namespace {

/// One figure of the heading: "RMS residual, deg/h", "0.031 -> 0.007".
std::string figure_of_merit(std::string_view name, const std::string& value) {
  return fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", name, value);
}

std::string from_to(double before, double after, bool changed) {
  if (!changed) return number_text(before);
  return fmt::format("{} &rarr; {}", number_text(before), number_text(after));
}

std::string heading(const Diagnosis& d, const VerdictWords& words, const config::ModelFile& model,
                    const std::string& data_name) {
  return fmt::format(
      "<header class=\"verdict{}\">\n<h1>{}</h1>\n<p>{}</p>\n<p class=\"to-do\">{}</p>\n"
      "<p class=\"sub\">{} &middot; model: {}</p>\n</header>\n",
      d.verdict == Verdict::kNothingMissing ? "" : " fails", escaped(words.verdict),
      escaped(words.evidence), escaped(words.to_do), escaped(data_name), escaped(model.name));
}

std::string figures_of_merit(const Diagnosis& d, std::string_view unit) {
  if (d.ladder.empty()) return "";
  const LadderStep &first = d.ladder.front(), &last = d.ladder.back();
  const bool changed = d.ladder.size() > 1;
  const std::string in = with_unit(unit);
  std::string out = "<dl class=\"figures\">\n";
  out += figure_of_merit("RMS residual" + in, from_to(first.rms, last.rms, changed));
  out += figure_of_merit("RMS on rows held out of the fit" + in,
                         from_to(first.heldout_rms, last.heldout_rms, changed));
  out += figure_of_merit("noise alone would leave" + in, number_text(d.noise_floor));
  out += figure_of_merit("chance that noise alone looks so (p)", p_text(d.p_adequate));
  return out + "</dl>\n";
}

std::string details_section(const Diagnosis& d, const VerdictWords& words) {
  std::string items;
  for (const std::string& sentence : words.details) {
    items += fmt::format("<li>{}</li>\n", escaped(sentence));
  }
  for (const std::string& note : d.notes) items += fmt::format("<li>{}</li>\n", escaped(note));
  for (const std::string& warning : d.after.warnings) {
    items += fmt::format("<li>Warning: {}</li>\n", escaped(warning));
  }
  return items.empty() ? "" : "<h2>In detail</h2>\n<ul>\n" + items + "</ul>\n";
}

std::string plots(const PlottedFits& fits) {
  std::string out = "<h2>Model and measurements</h2>\n";
  if (fits.after) {
    out +=
        "<form class=\"switch\" hidden=\"hidden\">Show "
        "<label><input type=\"radio\" name=\"show\" value=\"both\" checked=\"checked\"> both"
        "</label> <label><input type=\"radio\" name=\"show\" value=\"before\"> before</label> "
        "<label><input type=\"radio\" name=\"show\" value=\"after\"> after</label></form>\n";
  }
  out += plot_legend(fits) + "<div class=\"plots\">\n" + measured_against_model(fits) +
         residual_plots(fits) + "</div>\n";
  const std::string loops = loop_plots(fits);
  if (loops.empty()) return out;
  return out + "<h2>The residual up and down: an open loop is hysteresis or drift</h2>\n" +
         loop_legend(fits) + "<div class=\"plots\">\n" + loops + "</div>\n";
}

std::string footer(const Diagnosis& d, const config::ModelFile& model,
                   const std::string& data_name) {
  std::string out = fmt::format("<footer><p>{} &middot; model: {} &middot; {} rows analysed",
                                escaped(data_name), escaped(model.name), d.table.rows());
  if (d.rows_per_bin > 1) {
    out += fmt::format(", each the mean of up to {} rows of the data", d.rows_per_bin);
  }
  out += fmt::format(" &middot; false alarms: {:.3g} % of models that miss nothing.</p>\n",
                     100.0 * d.false_alarm_rate);
  return out + provenance_text(d.table) + "</footer>\n";
}

}  // namespace

std::string diagnosis_html(const Diagnosis& d, const VerdictWords& words,
                           const config::ModelFile& model, const std::string& data_name) {
  const std::string_view unit = config::unit_of(model.observable);
  const PlottedFits fits{.table = d.table,
                         .model = model,
                         .comparison = d.before,
                         .after = d.missing.empty() ? nullptr : &d.after,
                         .noise_floor = d.noise_floor};
  return page_start("Diagnosis of " + data_name) + heading(d, words, model, data_name) +
         figures_of_merit(d, unit) + ladder_section(d, unit) + ranking_section(d) +
         details_section(d, words) + plots(fits) + failures_section(d) + parameters_section(d) +
         next_section(d) + noise_section(d) + bounds_section(d) + not_testable_section(d) +
         footer(d, model, data_name) + page_end(rows_json(fits));
}

}  // namespace fogbench::model
