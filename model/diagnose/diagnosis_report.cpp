#include "model/diagnose/diagnosis_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "config/units.hpp"
#include "model/diagnose/diagnosis_tables.hpp"
#include "model/report_page.hpp"
#include "model/report_plots.hpp"
#include "model/svg_plot.hpp"

namespace fogbench::model {
namespace {

std::string_view in_short(Verdict verdict) {
  switch (verdict) {
    case Verdict::kNothingMissing:
      return "Nothing is missing";
    case Verdict::kMissingEffect:
      return "An effect is missing";
    case Verdict::kAmbiguous:
      return "Several effects could be missing";
    case Verdict::kUnexplained:
      return "Something is left unexplained";
  }
  return "";
}

/// One figure of the heading: "RMS residual, deg/h", "0.031 -> 0.007".
std::string figure_of_merit(std::string_view name, const std::string& value) {
  return fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", name, value);
}

std::string from_to(double before, double after, bool changed) {
  if (!changed) return number_text(before);
  return fmt::format("{} &rarr; {}", number_text(before), number_text(after));
}

std::string heading(const Diagnosis& d, const config::ModelFile& model,
                    const std::string& data_name) {
  std::string out = fmt::format(
      "<header class=\"verdict{}\">\n<p class=\"kicker\">{}</p>\n<h1>{}</h1>\n",
      d.verdict == Verdict::kNothingMissing ? "" : " fails", in_short(d.verdict),
      escaped(d.sentences.empty() ? std::string(in_short(d.verdict)) : d.sentences.front()));
  out += fmt::format("<p class=\"sub\">{} &middot; model: {}</p>\n", escaped(data_name),
                     escaped(model.name));
  for (std::size_t i = 1; i < d.sentences.size(); ++i) {
    out += fmt::format("<p>{}</p>\n", escaped(d.sentences[i]));
  }
  for (const std::string& note : d.notes) out += fmt::format("<p>{}</p>\n", escaped(note));
  for (const std::string& warning : d.after.warnings) {
    out += fmt::format("<p>Warning: {}</p>\n", escaped(warning));
  }
  return out + "</header>\n";
}

std::string figures_of_merit(const Diagnosis& d, std::string_view unit) {
  const bool changed = !d.missing.empty();
  const std::string in = with_unit(unit);
  std::string out = "<dl class=\"figures\">\n";
  out += figure_of_merit("chance that noise alone looks so bad (p)", p_text(d.p_adequate));
  out += figure_of_merit("RMS residual" + in, from_to(d.before.fit.rms, d.after.rms, changed));
  out += figure_of_merit(
      "RMS on rows held out" + in,
      from_to(d.heldout_rms, changed ? d.missing.back().heldout_rms_after : 0.0, changed));
  out += figure_of_merit("noise alone would leave" + in, number_text(d.noise_floor));
  return out + "</dl>\n";
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
  return out + fmt::format(
                   " &middot; false alarms: {:.3g} % of models that miss nothing.</p>"
                   "</footer>\n",
                   100.0 * d.false_alarm_rate);
}

}  // namespace

std::string diagnosis_html(const Diagnosis& d, const config::ModelFile& model,
                           const std::string& data_name) {
  const std::string_view unit = config::unit_of(model.observable);
  const PlottedFits fits{.table = d.table,
                         .model = model,
                         .comparison = d.before,
                         .after = d.missing.empty() ? nullptr : &d.after,
                         .noise_floor = d.noise_floor};
  return page_start("Diagnosis of " + data_name) + heading(d, model, data_name) +
         figures_of_merit(d, unit) + ladder_section(d, unit) + plots(fits) + failures_section(d) +
         ranking_section(d) + parameters_section(d) + noise_section(d) + bounds_section(d) +
         not_testable_section(d) + next_section(d) + footer(d, model, data_name) +
         page_end(rows_json(fits));
}

}  // namespace fogbench::model
