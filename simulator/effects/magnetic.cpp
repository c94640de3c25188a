// Effects of the field in the gyro's axes, in units of 100 uT, and of its history.

#include <cmath>
#include <optional>

#include "simulator/effects/effect.hpp"
#include "simulator/effects/memory.hpp"

namespace fogbench::simulator {
namespace {

void add_axis(std::vector<EffectEntry>& entries, const std::string& axis, std::size_t i) {
  const auto add = [&](const std::string& family, std::vector<EffectParameter> parameters,
                       std::function<Regressor(std::span<const double>)> make) {
    entries.push_back(
        {"magnetic_" + family + "_" + axis, std::move(parameters), std::move(make), true});
  };
  add("linear", {}, [i](auto) { return [i](const TrueState& s) { return s.field_100ut[i]; }; });
  add("quadratic", {}, [i](auto) {
    return [i](const TrueState& s) { return s.field_100ut[i] * s.field_100ut[i]; };
  });
  add("saturation", {{"hs"}}, [i](auto inner) {
    return [i, hs = inner[0]](const TrueState& s) { return std::tanh(s.field_100ut[i] / hs); };
  });
  add("hysteresis", {{"width", ParameterDomain::kNotNegative}}, [i](auto inner) {
    return [i, play = Play(inner[0])](const TrueState& s) mutable {
      return play.follow(s.field_100ut[i]);
    };
  });
  // Every step of the field decays by itself: the field less its lagged self.
  add("settling", {{"tau"}}, [i](auto inner) {
    return [i, tau = inner[0], lag = std::optional<Lag>()](const TrueState& s) mutable {
      const double h = s.field_100ut[i];
      if (!lag) lag.emplace(tau, h);  // The field at power-on had been there long before.
      return h - lag->follow(h, s.step_s);
    };
  });
  add("temperature", {}, [i](auto) {
    return [i](const TrueState& s) { return s.field_100ut[i] * s.above_reference_c(); };
  });
  add("temperature_rate", {}, [i](auto) {
    return [i](const TrueState& s) { return s.field_100ut[i] * s.temperature_rate_c_per_h; };
  });
}

}  // namespace

void add_magnetic_effects(std::vector<EffectEntry>& entries) {
  const std::string axes = "xyz";
  for (std::size_t i = 0; i < 3; ++i) {
    add_axis(entries, axes.substr(i, 1), i);
    const std::size_t j = (i + 1) % 3;
    entries.push_back({std::string("magnetic_cross_") + axes[i] + axes[j],
                       {},
                       [i, j](auto) {
                         return [i, j](const TrueState& s) {
                           return s.field_100ut[i] * s.field_100ut[j];
                         };
                       },
                       true});
  }
}

}  // namespace fogbench::simulator
