#include "cli/diagnosis_json.hpp"

#include <nlohmann/json.hpp>

#include "config/noise_parts.hpp"
#include "model/diagnose/verdict_text.hpp"

namespace fogbench::cli {
namespace {

using nlohmann::ordered_json;

/// {"term": ..., "remanence": {"value": ..., "expanded_uncertainty": ..., "unit": "deg/h"}, ...}
ordered_json loop_json(const model::MissingEffect& m) {
  if (!m.loop) return nullptr;
  ordered_json out{{"term", m.terms.front()}};
  for (const model::Estimate* e : {&m.loop->remanence, &m.loop->coercive}) {
    out[e->name] = {{"value", e->value},
                    {"expanded_uncertainty", e->coverage_factor * e->standard_error},
                    {"unit", e->unit}};
  }
  return out;
}

ordered_json missing_json(const model::MissingEffect& m) {
  ordered_json parameters = ordered_json::object(), coefficients = ordered_json::object(),
               errors = ordered_json::object(), rivals = ordered_json::array();
  for (const model::Estimate& e : m.estimates) {
    // "warm_up.tau" is an inner parameter, "earth_rate_projection.cos" a coefficient.
    (e.inner ? parameters[e.name.substr(e.name.rfind('.') + 1)] : coefficients[e.name]) = e.value;
    errors[e.name] = e.coverage_factor * e.standard_error;
  }
  for (const model::Rival& r : m.found.rivals) {
    rivals.push_back({{"effect", r.effect}, {"probability", r.probability}});
  }
  return {{"effect", m.found.effect},
          {"probability", m.found.probability},
          {"p_value", m.found.p_value},
          {"parameters", parameters},
          {"coefficients", coefficients},
          {"expanded_uncertainty", errors},
          {"loop", loop_json(m)},
          {"identified", !m.found.inner_at_edge},
          {"rms_after", m.rms_after},
          {"heldout_rms_after", m.heldout_rms_after},
          {"heldout_blocks_better", {m.found.heldout.better, m.found.heldout.folds}},
          {"or_shape", m.found.or_shape.empty() ? ordered_json() : ordered_json(m.found.or_shape)},
          {"rivals", rivals}};
}

std::string_view noise_source(const model::Diagnosis& d) {
  switch (d.noise_source) {
    case model::NoisePrior::Source::kInstruments:
      return "prior";
    case model::NoisePrior::Source::kGiven:
      return "given";
    case model::NoisePrior::Source::kStaticRecord:
      return "quiet record";
  }
  return "";
}

}  // namespace

ordered_json diagnosis_json(const model::Diagnosis& d, const std::string& next_step) {
  ordered_json failures = ordered_json::array(), missing = ordered_json::array(),
               not_testable = ordered_json::array(), bounds = ordered_json::array(),
               next = ordered_json::array(), ladder = ordered_json::array(),
               left_out = ordered_json::array();
  for (const model::LeftOut& row : d.left_out) {
    left_out.push_back({{"row", row.row + 1},
                        {"off_deg_per_h", row.off},
                        {"sigmas", row.sigmas},
                        {"says", row.says}});
  }
  for (const model::Region& r : d.before.regions) {
    if (!d.before.noise_known || r.p_family_wise > d.false_alarm_rate) continue;
    failures.push_back({{"where", r.where},
                        {"variable", r.variable},
                        {"range", {r.from, r.to}},
                        {"residual_deg_per_h", r.offset},
                        {"z", r.z},
                        {"p_value", r.p_family_wise},
                        {"says", r.says}});
  }
  for (const model::MissingEffect& m : d.missing) missing.push_back(missing_json(m));
  for (const model::NotTestable& n : d.not_testable) {
    not_testable.push_back({{"effect", n.effect}, {"because", n.because}});
  }
  for (const model::Bound& b : d.bounds) {
    bounds.push_back(
        {{"effect", b.effect}, {"absent_or_below", b.absent_or_below}, {"unit", b.unit}});
  }
  for (const model::NextMeasurement& n : d.next_measurements) {
    next.push_back(
        {{"tells_apart", n.tells_apart},
         {"do", n.action},
         {"expected_sigma", n.separation > 0.0 ? ordered_json(n.separation) : ordered_json()},
         {"bench_hours", n.hours > 0.0 ? ordered_json(n.hours) : ordered_json()}});
  }
  for (const model::LadderStep& step : d.ladder) {
    ladder.push_back({{"added", step.added.empty() ? ordered_json() : ordered_json(step.added)},
                      {"rms", step.rms},
                      {"heldout_rms", step.heldout_rms}});
  }
  std::vector<std::string> warnings = d.notes;
  warnings.insert(warnings.end(), d.after.warnings.begin(), d.after.warnings.end());
  ordered_json beside = ordered_json::array();
  if (d.unexplained.beside_found) {
    for (const model::MissingEffect& m : d.missing) beside.push_back(m.found.effect);
  }
  const std::string_view verdict = model::verdict_of(d);
  const std::string& suggestion = d.unexplained.suggestion;
  // Without times and durations the noise is only known to be independent from row to row.
  ordered_json noise = config::noise_json(d.noise);
  if (!d.table.has("time_s")) {
    for (auto& value : noise) value = nullptr;
  }
  return {
      {"verdict", verdict},
      {"p_adequate", verdict == "cannot_tell" ? ordered_json() : ordered_json(d.p_adequate)},
      {"false_alarm_rate", d.false_alarm_rate},
      {"fit",
       {{"rms_deg_per_h", d.before.fit.rms},
        {"heldout_rms_deg_per_h", d.heldout_rms},
        {"noise_floor_deg_per_h", d.noise_floor},
        {"white_floor_deg_per_h", d.floor.white},
        {"noise_floor_5_95_deg_per_h", {d.floor.low, d.floor.high}}}},
      {"noise", noise},
      {"noise_source", noise_source(d)},
      {"failures", failures},
      {"left_out", left_out},
      {"missing", missing},
      {"ambiguous", d.ambiguous},
      {"unexplained",
       {{"p_value", d.unexplained.p_value},
        {"depends_on", d.unexplained.depends_on},
        {"shape", d.unexplained.shape.empty() ? ordered_json() : ordered_json(d.unexplained.shape)},
        {"suggestion", suggestion.empty() ? ordered_json() : ordered_json(suggestion)},
        {"suggestion_beside", beside},
        {"suggestion_heldout_rms", d.unexplained.heldout_rms}}},
      {"not_testable", not_testable},
      {"bounds", bounds},
      {"next_measurements", next},
      {"ladder", ladder},
      {"sentences", model::verdict_in_words(d, next_step).sentences()},
      {"warnings", warnings},
      {"read_as", d.table.provenance()},
      {"next", next_step}};
}

}  // namespace fogbench::cli
