#include "simulator/hidden_effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "config/nearest_name.hpp"

namespace fogbench::simulator {
namespace {

Error unknown(const std::string& where, std::string_view what, const std::string& name,
              const std::vector<std::string_view>& known) {
  std::string hint = config::did_you_mean(name, known);
  if (hint.empty()) {
    hint = known.empty() ? "; it takes none" : fmt::format("; known: {}", fmt::join(known, ", "));
  }
  return Error{ErrorCode::kBadInput,
               fmt::format("{}: unknown {} \"{}\"{}", where, what, name, hint)};
}

Error no_such_effect(const std::string& where, const std::string& name) {
  std::vector<std::string> names;
  for (const EffectEntry& entry : all_effects()) {
    names.push_back(entry.of_a_channel ? entry.id + "(CHANNEL)" : entry.id);
  }
  return unknown(where, "effect", name, {names.begin(), names.end()});
}

Status check_domain(const std::string& where, const EffectParameter& parameter, double value) {
  const bool good =
      std::isfinite(value) && (parameter.domain == ParameterDomain::kAny || value > 0.0 ||
                               (parameter.domain == ParameterDomain::kNotNegative && value == 0.0));
  if (good) return {};
  constexpr std::string_view kExpected[] = {"a finite number", "a number not below 0",
                                            "a number above 0"};
  return Error{ErrorCode::kBadInput,
               fmt::format("{}: {} is {}, expected {}", where, parameter.name, value,
                           kExpected[static_cast<std::size_t>(parameter.domain)])};
}

}  // namespace

Status HiddenEffects::add(const config::HiddenEffect& hidden, const std::string& where) {
  const std::optional<NamedEffect> found = find_effect(hidden.effect);
  if (!found) return no_such_effect(where, hidden.effect);
  const EffectEntry& entry = *found->entry;

  std::vector<std::string_view> known;
  Given values{.channel = found->channel};
  for (const EffectParameter& parameter : entry.parameters) {
    known.push_back(parameter.name);
    const auto given = hidden.parameters.find(parameter.name);
    if (given == hidden.parameters.end()) {
      if (parameter.required) {
        return Error{ErrorCode::kBadInput, fmt::format("{}: {} needs the parameter \"{}\"", where,
                                                       entry.id, parameter.name)};
      }
      values.inner.push_back(0.0);
      continue;
    }
    if (Status s = check_domain(where, parameter, given->second); !s) return s;
    values.inner.push_back(given->second);
  }
  for (const auto& [name, value] : hidden.parameters) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      return unknown(where, fmt::format("parameter of {}", entry.id), name, known);
    }
  }
  if (!std::isfinite(hidden.amplitude)) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("{}: the amplitude of {} is not a finite number", where, entry.id)};
  }
  terms_.push_back({hidden.amplitude, entry.through_shield, entry.make(values)});
  if (!values.channel.empty()) channels_.push_back({where, hidden.effect, values.channel});
  return {};
}

Result<HiddenEffects> HiddenEffects::create(const config::ScenarioConfig& scenario) {
  HiddenEffects effects;
  for (const auto& [id, coefficient] : scenario.terms) {
    const config::HiddenEffect term{.effect = id, .amplitude = coefficient, .parameters = {}};
    if (Status s = effects.add(term, "scenario: /gyro/terms/" + id); !s) return s.error();
  }
  for (std::size_t i = 0; i < scenario.hidden.size(); ++i) {
    if (Status s = effects.add(scenario.hidden[i], fmt::format("scenario: /hidden/{}", i)); !s) {
      return s.error();
    }
  }
  effects.scale_changes_ = scenario.magnetic_scale;
  std::stable_sort(effects.scale_changes_.begin(), effects.scale_changes_.end(),
                   [](const auto& a, const auto& b) { return a.at < b.at; });
  return effects;
}

double HiddenEffects::advance(const TrueState& state) {
  double magnetic_scale = 1.0;
  for (const config::MagneticScaleChange& change : scale_changes_) {
    if (state.time_s >= change.at.count()) magnetic_scale = change.factor;
  }
  double rate = 0.0;
  for (Term& term : terms_) {
    rate += (term.magnetic ? magnetic_scale : 1.0) * term.amplitude * term.regressor(state);
  }
  return rate;
}

}  // namespace fogbench::simulator
