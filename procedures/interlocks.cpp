#include "procedures/interlocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace fogbench::procedures {

using config::InterlockAction;
using config::InterlockKindInfo;

Interlocks::Interlocks(const config::BenchConfig& bench) {
  const auto calibrations = calibrations_of(bench);
  for (const config::InterlockConfig& config : bench.interlocks) {
    Interlock& interlock = interlocks_.emplace_back(Interlock{config, {}});
    for (const auto& condition : config.conditions()) {
      interlock.conditions.push_back({InterlockGauge(condition, calibrations), {}});
    }
  }
}

Interlocks::Finding Interlocks::finding_of(const config::InterlockCondition& condition,
                                           double value) {
  if (std::isnan(value)) return Finding::kMissing;
  const double side = worse_upwards(condition.kind);
  if (side * value > side * condition.trip) return Finding::kViolated;
  return side * value <= side * condition.clear ? Finding::kClear : Finding::kBetween;
}

Interlocks::Finding Interlocks::combine(const Interlock& interlock) {
  const auto all = [&](Finding finding) {
    return std::all_of(interlock.conditions.begin(), interlock.conditions.end(),
                       [finding](const Measured& m) { return m.finding == finding; });
  };
  const auto any = [&](Finding finding) {
    return std::any_of(interlock.conditions.begin(), interlock.conditions.end(),
                       [finding](const Measured& m) { return m.finding == finding; });
  };
  const bool needs_all = !interlock.config.all_of.empty();
  if (needs_all ? all(Finding::kViolated) : any(Finding::kViolated)) return Finding::kViolated;
  if (needs_all ? any(Finding::kClear) : all(Finding::kClear)) return Finding::kClear;
  return any(Finding::kMissing) ? Finding::kMissing : Finding::kBetween;
}

std::vector<InterlockChange> Interlocks::observe(const Observation& seen) {
  std::vector<InterlockChange> changes;
  for (Interlock& interlock : interlocks_) {
    for (Measured& m : interlock.conditions) {
      GaugeReading reading = m.gauge.measure(seen);
      m.finding = finding_of(m.gauge.condition(), reading.value);
      if (m.finding != Finding::kMissing) m.reading = std::move(reading);
    }
    const Finding finding = combine(interlock);
    if (finding == Finding::kMissing) continue;
    interlock.in_a_row = finding == Finding::kViolated ? interlock.in_a_row + 1 : 0;
    const bool trips = !interlock.tripped && interlock.in_a_row >= interlock.config.consecutive;
    const bool clears = interlock.tripped && finding == Finding::kClear;
    if (!trips && !clears) continue;
    interlock.tripped = trips;
    changes.push_back(change_of(interlock));
  }
  return changes;
}

bool Interlocks::undecided() const {
  return std::any_of(interlocks_.begin(), interlocks_.end(),
                     [](const Interlock& i) { return i.in_a_row > 0 && !i.tripped; });
}

std::vector<std::string> Interlocks::tripped() const {
  std::vector<std::string> sentences;
  for (const Interlock& interlock : interlocks_) {
    if (interlock.tripped) sentences.push_back(sentence(interlock));
  }
  return sentences;
}

std::vector<std::string> Interlocks::tripped(InterlockAction action) const {
  std::vector<std::string> sentences;
  for (const Interlock& interlock : interlocks_) {
    if (interlock.tripped && interlock.config.action == action) {
      sentences.push_back(sentence(interlock));
    }
  }
  return sentences;
}

std::string Interlocks::sentence(const Interlock& interlock) {
  std::string text = fmt::format("interlock {}", interlock.config.name);
  const char* before = ": ";
  for (const Measured& m : interlock.conditions) {
    if (std::isnan(m.reading.value)) continue;
    const config::InterlockCondition& condition = m.gauge.condition();
    const InterlockKindInfo& info = info_of(condition.kind);
    text += fmt::format("{}{}: {} {:.6g} {} (trips {} {:g}, clears at {:g})", before,
                        m.reading.where, info.says, m.reading.value, unit_of(condition),
                        worse_upwards(condition.kind) > 0.0 ? "above" : "below", condition.trip,
                        condition.clear);
    before = interlock.config.all_of.empty() ? " or " : " and ";
  }
  return text;
}

InterlockChange Interlocks::change_of(const Interlock& interlock) {
  nlohmann::ordered_json data{{"interlock", interlock.config.name},
                              {"state", interlock.tripped ? "tripped" : "cleared"},
                              {"action", name_of(interlock.config.action)},
                              {"in_a_row", interlock.in_a_row},
                              {"consecutive", interlock.config.consecutive}};
  for (const Measured& m : interlock.conditions) {
    const config::InterlockCondition& condition = m.gauge.condition();
    const InterlockKindInfo& info = info_of(condition.kind);
    // A value that has never been there is null.
    data["conditions"].push_back({{"kind", info.name},
                                  {"where", m.reading.where},
                                  {"value", m.reading.value},
                                  {"trip", condition.trip},
                                  {"clear", condition.clear},
                                  {"unit", unit_of(condition)}});
  }
  return {
      interlock.tripped, interlock.config.action,
      sentence(interlock) + (interlock.tripped ? fmt::format(", {} in a row", interlock.in_a_row)
                                               : std::string(": cleared")),
      data.dump()};
}

}  // namespace fogbench::procedures
