#include "procedures/reach.hpp"

#include <algorithm>

namespace fogbench::procedures {

using config::Celsius;
using config::CelsiusPerHour;
using config::HeatingMode;

Celsius Reach::highest() const {
  return room_ + Celsius{rise_c(figures_.normal.value)};
}

Celsius Reach::lowest() const {
  return room_ - Celsius{rise_c(figures_.cooling.value)};
}

double Reach::heating_c_per_h(HeatingMode mode) const {
  // In boost mode the normal heater takes over near the target.
  return mode == HeatingMode::kBoost ? std::max(figures_.boost, figures_.normal).value
                                     : figures_.normal.value;
}

CelsiusPerHour Reach::fastest_up(Celsius at, HeatingMode mode) const {
  return CelsiusPerHour{heating_c_per_h(mode) - (at - room_).value / rise_c(1.0)};
}

CelsiusPerHour Reach::fastest_down(Celsius at) const {
  return CelsiusPerHour{figures_.cooling.value + (at - room_).value / rise_c(1.0)};
}

Celsius Reach::end_up(CelsiusPerHour rate, HeatingMode mode) const {
  return room_ + Celsius{rise_c(heating_c_per_h(mode) - rate.value)};
}

Celsius Reach::end_down(CelsiusPerHour rate) const {
  return room_ + Celsius{rise_c(rate.value - figures_.cooling.value)};
}

std::optional<Reach> reach_of(const config::BenchConfig& bench) {
  if (!bench.thermal) return std::nullopt;
  return Reach(*bench.thermal, bench.estimates.room);
}

}  // namespace fogbench::procedures
