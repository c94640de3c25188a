#include "cli/draw_challenge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "model/effects/catalogue.hpp"
#include "model/effects/sensitivity.hpp"
#include "simulator/effects/effect.hpp"
#include "simulator/random.hpp"

namespace fogbench::cli {
namespace {

/// The effects of one family: the axis is drawn after it.
using Kind = std::vector<const model::EffectInfo*>;

/// The simulator can hide it there: what acts on an auxiliary channel needs the sensor.
bool can_hide(const std::string& effect, const ChallengeRoom& room) {
  const auto hidden = simulator::find_effect(effect);
  return hidden && (hidden->channel.empty() || std::find(room.channels.begin(), room.channels.end(),
                                                         hidden->channel) != room.channels.end());
}

/// Those that ready procedures tell from the others. `acceptance` sweeps and heats: it shows them
/// all. Last come the causes that only the room has, which no procedure moves.
std::vector<Kind> kinds(bool swept, bool heated, const ChallengeRoom& room) {
  std::vector<Kind> out;
  for (const model::Effect* effect : model::catalogue()) {
    const model::EffectInfo& info = effect->info();
    if (!info.in_challenge || !can_hide(info.id, room)) continue;
    using By = model::InChallenge::By;
    const By by = info.in_challenge->by;
    if ((by == By::kSweep && !swept) || (by == By::kHeating && !heated)) continue;
    if (out.empty() || info.family.empty() || out.back().front()->family != info.family) {
      out.emplace_back();
    }
    out.back().push_back(&info);
  }
  std::sort(out.begin(), out.end(), [](const Kind& a, const Kind& b) {
    return a.front()->in_challenge->place < b.front()->in_challenge->place;
  });
  Kind recorded;
  for (const std::string& channel : room.channels) {
    const auto& form = model::effects::kSensitivityForms.front();
    const std::string id = model::effects::sensitivity_of(form, channel);
    if (can_hide(id, room)) recorded.push_back(&model::find_effect(id)->info());
  }
  if (!recorded.empty()) out.push_back(std::move(recorded));
  return out;
}

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : source_(simulator::derive_seed(seed, "challenge")) {}

  bool chance(double probability) { return source_.uniform() < probability; }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }
  double uniform(double minimum, double maximum) {
    return minimum + (maximum - minimum) * source_.uniform();
  }
  double logarithmic(double minimum, double maximum) {
    return minimum * std::pow(maximum / minimum, source_.uniform());
  }
  std::size_t index(std::size_t size) {
    return static_cast<std::size_t>(source_.uniform() * static_cast<double>(size));
  }

  /// Uniform in the logarithm of a range that does not begin at 0.
  config::HiddenEffect effect(const model::EffectInfo& info) {
    config::HiddenEffect hidden;
    hidden.effect = info.id;
    hidden.amplitude = sign();
    if (!info.in_challenge) return hidden;
    for (const auto& [parameter, range] : info.in_challenge->ranges) {
      hidden.parameters[parameter] =
          three_digits(range.minimum > 0.0 ? logarithmic(range.minimum, range.maximum)
                                           : uniform(range.minimum, range.maximum));
    }
    return hidden;
  }

 private:
  simulator::NormalSource source_;
};

/// Sizes of a good gyro, deg/h per unit of each term.
void add_passport(Draw& draw, bool swept, bool heated, ChallengeDraw& out) {
  const auto add = [&](const std::string& effect, double minimum, double maximum) {
    out.scenario.terms[effect] = three_digits(draw.sign() * draw.logarithmic(minimum, maximum));
    config::ModelTerm term;
    term.effect = effect;
    out.model.terms.push_back(std::move(term));
  };
  add("bias", 0.1, 2.0);
  if (heated) add("temperature_linear", 0.01, 0.05);
  for (const char* axis : {"x", "y", "z"}) {
    if (swept) add(std::string("magnetic_linear_") + axis, 0.02, 0.3);
  }
}

}  // namespace

double three_digits(double value) {
  const std::string text = fmt::format("{:.3g}", value);
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

ChallengeDraw draw_challenge(std::uint64_t seed, const ChallengeRoom& room) {
  Draw draw(seed);
  ChallengeDraw out;
  out.bench = room.bench;
  out.bench_seed = simulator::derive_seed(seed, "challenge bench");

  // The procedure is drawn before the effects, so that it does not tell how many there are.
  const double which = draw.uniform(0.0, 1.0);
  const bool swept = which < 0.6, heated = which >= 0.4;
  out.procedure = !heated ? "coil-sweep" : !swept ? "thermostat-steps" : "acceptance";
  // Only a cooling branch tells a hysteresis from a curve.
  if (!swept) out.set["cooling_c"] = {45.0, 35.0, 25.0};

  out.noise = draw.chance(0.25) ? "tactical" : "navigation";
  out.scenario.name = "challenge";
  out.scenario.noise = *config::noise_grade(out.noise);
  add_passport(draw, swept, heated, out);
  out.model.name = "start";
  out.model.description = "A bias and what the procedure excites, linear: all left to the fit.";

  std::vector<Kind> possible = kinds(swept, heated, room);
  const double how_many = draw.uniform(0.0, 1.0);
  const std::size_t count = how_many < 0.125 ? 0 : how_many < 0.325 ? 2 : 1;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t chosen = draw.index(possible.size());
    const Kind& kind = possible[chosen];
    const std::size_t axis = kind.size() > 1 ? draw.index(kind.size()) : 0;
    out.scenario.hidden.push_back(draw.effect(*kind[axis]));
    out.visibility.push_back(draw.logarithmic(3.0, 8.0));
    possible.erase(possible.begin() + static_cast<std::ptrdiff_t>(chosen));
  }
  return out;
}

std::vector<std::string> hideable_effects(const ChallengeRoom& room) {
  std::vector<std::string> all;
  for (const Kind& kind : kinds(true, true, room)) {
    for (const model::EffectInfo* info : kind) all.push_back(info->id);
  }
  return all;
}

}  // namespace fogbench::cli
