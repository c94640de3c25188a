#include "acceptance/passport.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "acceptance/conditions.hpp"
#include "config/nearest_name.hpp"
#include "config/rounding.hpp"

namespace fogbench::acceptance {
namespace {

/// A text keeps its last full stop to itself.
std::string without_stop(std::string sentence) {
  while (sentence.ends_with('.')) sentence.pop_back();
  return sentence;
}

void remark_calibrations(const RunProvenance& made, std::vector<Remark>& out) {
  const std::string number = std::to_string(made.run.run);
  const std::string today = made.run.header.started_at.substr(0, 10);
  std::vector<std::string> overdue, undated;
  for (const auto& instrument : made.instruments) {
    if (instrument.role == "gyro") continue;  // it is what is being tested
    if (instrument.calibration_due.empty()) {
      undated.push_back(instrument.role);
    } else if (instrument.calibration_due < today) {
      overdue.push_back(fmt::format("{} ({})", instrument.role, instrument.calibration_due));
    }
  }
  if (!overdue.empty()) out.push_back({Text::kRemarkOverdue, number, overdue});
  if (!undated.empty()) out.push_back({Text::kRemarkNoCalibration, number, undated});
}

/// A limit whose quantity nothing is called: a slip of the pen, which nothing would ever meet.
void remark_names(const Acceptance& acceptance, const config::LimitsConfig& limits,
                  std::vector<Remark>& out) {
  std::vector<std::string_view> known;
  for (const model::Measured& m : acceptance.measured) known.push_back(m.quantity);
  for (const config::Limit& limit : limits.limits) {
    if (is_quantity(limit.quantity)) continue;
    if (std::find(known.begin(), known.end(), limit.quantity) != known.end()) continue;
    std::string near(config::nearest_name(limit.quantity, known));
    if (near.empty()) near = "?";
    out.push_back({Text::kRemarkNoQuantity, limit.quantity, {std::move(near)}});
  }
}

std::vector<Remark> remarks_on(const Acceptance& acceptance, const config::LimitsConfig& limits) {
  std::vector<Remark> out;
  remark_names(acceptance, limits, out);
  for (const RunProvenance& made : acceptance.runs) {
    const procedures::RunHeader& header = made.run.header;
    const std::string number = std::to_string(made.run.run);
    if (!made.whole()) {
      out.push_back({Text::kRemarkUnfinished, number, {made.run.outcome()}});
    }
    if (!made.raw_data_intact) out.push_back({Text::kRemarkRawData, number, {}});
    if (!header.scenario_json.empty()) out.push_back({Text::kRemarkSimulated, number, {}});
    if (header.gyro_serial_number.empty()) out.push_back({Text::kRemarkNoGyro, number, {}});
    if (header.operator_name.empty()) out.push_back({Text::kRemarkNoOperator, number, {}});
    remark_calibrations(made, out);
  }
  for (const TestResults& test : acceptance.tests) {
    if (!test.fit_problem.empty()) {
      out.push_back({Text::kRemarkNoFit, test.name, {without_stop(test.fit_problem)}});
    }
    if (!test.fit) continue;
    for (const std::string& warning : test.fit->warnings) {
      out.push_back({Text::kRemarkFit, test.name, {without_stop(warning)}});
    }
  }
  return out;
}

}  // namespace

Result<Passport> make_passport(Acceptance acceptance, config::LimitsConfig limits,
                               std::string issued_at, std::string software_version) {
  auto judged = model::judge_results(acceptance.measured, limits);
  if (!judged) return judged.error();
  for (const RunProvenance& made : acceptance.runs) {
    if (made.whole() && made.raw_data_intact) continue;
    judged->overall = model::worst_of(judged->overall, model::Conformity::kIndeterminate);
  }
  std::vector<Remark> remarks = remarks_on(acceptance, limits);
  return Passport{std::move(acceptance), std::move(limits),    std::move(*judged),
                  std::move(remarks),    std::move(issued_at), std::move(software_version)};
}

std::string remark_text(const Remark& remark, Language language) {
  std::vector<std::string> about;
  for (const std::string& thing : remark.about) {
    const std::size_t bracket = std::min(thing.find(" ("), thing.size());
    about.push_back(remark.text == Text::kRemarkUnfinished
                        ? std::string(outcome_name(thing, language))
                        : std::string(role_name(thing.substr(0, bracket), language)) +
                              thing.substr(bracket));
  }
  return fmt::format(fmt::runtime(text(remark.text, language)), remark.of, fmt::join(about, "; "));
}

std::string change_text(const model::RunChange& change, double coverage_factor, Language language) {
  const config::Rounded scale =
      config::rounded(change.common_scale, coverage_factor * change.scale_standard_error);
  const std::string p =
      change.p_repeat < 1e-4 ? "p < 0.0001" : fmt::format("p = {:.2g}", change.p_repeat);
  return fmt::format(fmt::runtime(text(Text::kChange, language)), change.run_a, change.run_b,
                     localised(scale.value, language), localised(scale.uncertainty, language),
                     localised(fmt::format("{:.1f}", change.angle_deg), language),
                     localised(p, language));
}

}  // namespace fogbench::acceptance
