#include "acceptance/passport_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "config/noise_parts.hpp"
#include "record/file_hash.hpp"
#include "record/store.hpp"

namespace fogbench::acceptance {
using nlohmann::ordered_json;

namespace {

/// Of the JSON of a passport: rises when a member changes its meaning or goes away.
constexpr int kPassportVersion = 1;

template <class T>
ordered_json nullable(const std::optional<T>& value) {
  return value ? ordered_json(*value) : ordered_json();
}

ordered_json nullable(const std::string& value) {
  return value.empty() ? ordered_json() : ordered_json(value);
}

template <class T, class Write>
ordered_json list_of(const std::vector<T>& rows, Write write) {
  ordered_json list = ordered_json::array();
  for (const T& row : rows) list.push_back(write(row));
  return list;
}

ordered_json conditions_json(const model::Conditions& at) {
  ordered_json field;
  if (!std::isnan(at.field_low_ut)) {
    field = {{"axes", at.axes}, {"range_ut", {at.field_low_ut, at.field_high_ut}}};
  }
  return {{"temperature_c", {at.temperature_low_c, at.temperature_high_c}}, {"field", field}};
}

ordered_json judgement_json(const model::Judgement& row) {
  return {{"quantity", row.quantity},
          {"test", nullable(row.test)},
          {"unit", row.unit},
          {"value", row.value},
          {"expanded_uncertainty", row.expanded_uncertainty},
          {"minimum", nullable(row.minimum)},
          {"maximum", nullable(row.maximum)},
          {"conditions", conditions_json(row.conditions)},
          {"tests_measured", row.tests_measured},
          {"tests_expected", row.tests_expected},
          {"verdict", name_of(row.verdict)}};
}

ordered_json repeat_json(const model::Repeat& row) {
  return {{"quantity", row.quantity},
          {"unit", row.unit},
          {"tests", {row.test_a, row.test_b}},
          {"values", {row.value_a, row.value_b}},
          {"difference", row.difference},
          {"expanded_uncertainty", row.expanded_uncertainty},
          {"significant", row.significant},
          {"limit", nullable(row.limit)},
          {"verdict", row.verdict ? ordered_json(name_of(*row.verdict)) : ordered_json()}};
}

ordered_json fit_json(const TestResults& test) {
  if (!test.fit) return test.fit_problem.empty() ? ordered_json() : ordered_json(test.fit_problem);
  const model::FitResult& fit = *test.fit;
  ordered_json out{{"model", test.model},
                   {"reference_temperature_c", fit.fitted.reference_temperature_c},
                   {"rows", fit.rows.size()},
                   {"degrees_of_freedom", fit.degrees_of_freedom},
                   {"rms_deg_per_h", fit.rms}};
  if (fit.coloured) out["noise"] = config::noise_json(fit.noise.noise);
  ordered_json names = ordered_json::array(), covariance = ordered_json::array();
  for (const model::Estimate& e : fit.estimates) {
    if (!e.held) names.push_back(e.name);
  }
  for (Eigen::Index row = 0; row < fit.covariance.rows(); ++row) {
    ordered_json values = ordered_json::array();
    for (Eigen::Index column = 0; column < fit.covariance.cols(); ++column) {
      values.push_back(fit.covariance(row, column));
    }
    covariance.push_back(std::move(values));
  }
  out["covariance"] = {{"of", names}, {"values", covariance}};
  out["warnings"] = fit.warnings;
  return out;
}

ordered_json test_json(const TestResults& test, const std::vector<model::Measured>& measured,
                       double coverage_factor) {
  ordered_json results = ordered_json::array();
  for (const model::Measured& m : measured) {
    if (m.test != test.name) continue;
    results.push_back({{"quantity", m.quantity},
                       {"unit", m.unit},
                       {"value", m.value},
                       {"standard_error", m.standard_error},
                       {"expanded_uncertainty", expanded_uncertainty(m, coverage_factor)}});
  }
  const auto set_point = [](const SetPoint& row) -> ordered_json {
    return {{"segment", row.segment},
            {"target_c", row.target_c},
            {"temperature_c", row.temperature_c},
            {"averages", row.averages},
            {"deviation_deg_per_h", row.deviation_deg_per_h.value},
            {"standard_error_deg_per_h", row.deviation_deg_per_h.standard_error},
            {"sigma_deg_per_h", row.sigma_deg_per_h}};
  };
  const auto level = [](const Deviation& row) -> ordered_json {
    return {{"segment", row.segment},
            {"field_set_ut", row.field_set_ut},
            {"field_ut", row.field_ut},
            {"deviation_deg_per_h", row.deviation_deg_per_h.value}};
  };
  return {{"test", test.name},
          {"run", test.run},
          {"results", results},
          {"fit", fit_json(test)},
          {"set_points", list_of(test.set_points, set_point)},
          {"field_levels", list_of(test.results.magnetic, level)}};
}

ordered_json noise_json(const NoiseTerms& terms) {
  ordered_json out{{"run", terms.run},
                   {"test", terms.stretch.test},
                   {"segment", terms.stretch.segment},
                   {"from_s", terms.stretch.from_s},
                   {"to_s", terms.stretch.to_s},
                   {"interval_s", terms.interval_s},
                   {"samples", terms.samples}};
  out["allan_deviation"] = list_of(terms.curve, [](const model::AllanPoint& p) -> ordered_json {
    return {{"tau_s", p.tau_s},
            {"deviation_deg_per_h", p.deviation_deg_per_h},
            {"standard_error_deg_per_h", p.standard_error_deg_per_h}};
  });
  return out;
}

ordered_json run_json(const RunProvenance& made) {
  const procedures::RunHeader& header = made.run.header;
  ordered_json out{
      {"run", made.run.run},
      {"outcome", made.run.outcome()},
      {"taken_up", made.taken_up},
      {"started_at", header.started_at},
      {"ended_at", made.run.end ? ordered_json(made.run.end->ended_at) : ordered_json()},
      {"gyro_serial_number", nullable(header.gyro_serial_number)},
      {"operator", nullable(header.operator_name)},
      {"software_version", header.software_version},
      {"procedure", header.procedure},
      {"procedure_sha256", record::text_sha256(header.procedure_json)},
      {"bench", header.bench},
      {"bench_sha256", record::text_sha256(header.bench_json)},
      {"simulated", !header.scenario_json.empty()},
      {"scenario_sha256", header.scenario_json.empty()
                              ? ordered_json()
                              : ordered_json(record::text_sha256(header.scenario_json))},
      {"seed", nullable(header.seed)},
      {"raw_sha256", made.raw_sha256},
      {"raw_data_intact", made.raw_data_intact},
      {"points", made.run.points},
      {"points_void", made.run.points_void},
      {"frames", made.run.frames_stored}};
  if (made.run.end) out["frames_missing"] = made.run.end->stream.frames_missing;
  out["instruments"] = list_of(made.instruments, [](const auto& row) -> ordered_json {
    return {{"role", row.role},
            {"identity", row.identity},
            {"serial_number", nullable(row.serial_number)},
            {"calibrated_on", nullable(row.calibrated_on)},
            {"calibration_due", nullable(row.calibration_due)}};
  });
  return out;
}

ordered_json change_json(const model::RunChange& change) {
  return {{"tests", {change.run_a, change.run_b}},
          {"common_scale", change.common_scale},
          {"scale_standard_error", change.scale_standard_error},
          {"angle_deg", change.angle_deg},
          {"p_repeat", change.p_repeat},
          {"scale_changed", change.scale_changed}};
}

}  // namespace

ordered_json verdict_json(const Passport& passport) {
  const model::Judged& judged = passport.judged;
  ordered_json runs = ordered_json::array();
  for (const RunProvenance& made : passport.acceptance.runs) runs.push_back(made.run.run);
  return {{"verdict", name_of(judged.overall)},
          {"gyro_serial_number", nullable(passport.acceptance.gyro())},
          {"runs", runs},
          {"limits",
           {{"name", passport.limits.name},
            {"coverage_factor", judged.coverage_factor},
            {"tests", passport.limits.tests}}},
          {"results", list_of(judged.results, judgement_json)},
          {"repeatability", list_of(judged.repeats, repeat_json)},
          {"remarks", list_of(passport.remarks, [](const Remark& remark) {
             return ordered_json(remark_text(remark, Language::kEnglish));
           })}};
}

ordered_json passport_json(const Passport& passport) {
  const Acceptance& a = passport.acceptance;
  ordered_json out{{"passport", kPassportVersion},
                   {"issued_at", passport.issued_at},
                   {"software_version", passport.software_version}};
  out.update(verdict_json(passport));
  out["tests"] = list_of(a.tests, [&](const TestResults& test) {
    return test_json(test, a.measured, passport.judged.coverage_factor);
  });
  out["changes"] = list_of(a.changes, change_json);
  out["noise"] = list_of(a.noise, noise_json);
  out["origin"] = list_of(a.runs, run_json);
  return out;
}

}  // namespace fogbench::acceptance
