#include "cli/draw_challenge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "simulator/random.hpp"

namespace fogbench::cli {
namespace {

/// By which ready procedures an effect shows; `acceptance` sweeps and heats, so it shows them all.
enum class ExcitedBy { kSweep, kHeating, kBoth };

/// An inner parameter's range: inside the typical one of the catalogue, and where the procedure can
/// tell it. The draw is uniform in its logarithm when the range does not begin at 0.
struct Range {
  std::string_view parameter;
  double minimum, maximum;
};

struct Kind {
  std::string_view effect;  ///< "magnetic_hysteresis_" takes an axis
  ExcitedBy by;
  std::vector<Range> inner = {};
};

// Left out is what these procedures cannot tell. magnetic_cross_*: two axes are never energised
// together. magnetic_temperature_*: no sweep at a second temperature. magnetic_settling_*: one
// window a level, in which it is a hysteresis of half a level's step to 4..14 % of its size; for
// the same reason the widths of the hystereses begin where nothing else has their shape.
// coil_heating: no field is held long enough.
// earth_rate_projection: one rotation is a bias step. ambient_temperature: the room hardly moves.
const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {"magnetic_quadratic_", ExcitedBy::kSweep},
      {"magnetic_saturation_", ExcitedBy::kSweep, {{"hs", 0.7, 2.0}}},
      {"magnetic_hysteresis_", ExcitedBy::kSweep, {{"width", 0.6, 1.5}}},
      {"temperature_quadratic", ExcitedBy::kHeating},
      {"temperature_cubic", ExcitedBy::kHeating},
      {"temperature_rate", ExcitedBy::kHeating},
      {"temperature_rate_lagged", ExcitedBy::kHeating, {{"tau", 200.0, 1200.0}}},
      {"temperature_rate_cross", ExcitedBy::kHeating},
      {"temperature_gradient", ExcitedBy::kHeating},
      {"temperature_hysteresis", ExcitedBy::kHeating, {{"width", 3.0, 8.0}}},
      {"temperature_ripple",
       ExcitedBy::kHeating,
       {{"period", 4.0, 10.0}, {"phase_deg", 0.0, 360.0}}},
      {"heater_power", ExcitedBy::kHeating},
      {"bias_step", ExcitedBy::kBoth, {{"t0", 3000.0, 8000.0}}},
      {"drift_linear", ExcitedBy::kBoth},
      {"warm_up", ExcitedBy::kBoth, {{"tau", 900.0, 3600.0}}}};
  return all;
}

bool takes_an_axis(const Kind& kind) {
  return kind.effect.back() == '_';
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

  config::HiddenEffect effect(const Kind& kind) {
    config::HiddenEffect hidden;
    hidden.effect = kind.effect;
    if (takes_an_axis(kind)) hidden.effect += "xyz"[index(3)];
    hidden.amplitude = sign();
    for (const Range& range : kind.inner) {
      hidden.parameters[std::string(range.parameter)] =
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

ChallengeDraw draw_challenge(std::uint64_t seed) {
  Draw draw(seed);
  ChallengeDraw out;
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

  std::vector<Kind> possible;
  std::copy_if(kinds().begin(), kinds().end(), std::back_inserter(possible), [&](const Kind& k) {
    return k.by == ExcitedBy::kBoth || (k.by == ExcitedBy::kSweep ? swept : heated);
  });
  const double how_many = draw.uniform(0.0, 1.0);
  const std::size_t count = how_many < 0.125 ? 0 : how_many < 0.325 ? 2 : 1;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t chosen = draw.index(possible.size());
    out.scenario.hidden.push_back(draw.effect(possible[chosen]));
    out.visibility.push_back(draw.logarithmic(3.0, 8.0));
    possible.erase(possible.begin() + static_cast<std::ptrdiff_t>(chosen));
  }
  return out;
}

std::vector<std::string> hideable_effects() {
  std::vector<std::string> all;
  for (const Kind& kind : kinds()) {
    if (!takes_an_axis(kind)) {
      all.emplace_back(kind.effect);
      continue;
    }
    for (const char axis : {'x', 'y', 'z'}) all.push_back(std::string(kind.effect) + axis);
  }
  return all;
}

}  // namespace fogbench::cli
