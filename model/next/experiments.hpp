#pragma once
// The experiments that this bench can do, each carried out on paper (bench_schedule.hpp).

#include <string>
#include <vector>

#include "config/bench.hpp"
#include "model/next/bench_schedule.hpp"

namespace fogbench::model {

struct Experiment {
  /// What it varies. Nobody heats to learn about a drift.
  struct About {
    bool field = false, temperature = false, azimuth = false;
    bool together = false;  ///< of use only for what acts through all of these
  };

  std::string key;     ///< "hold_z": short, for tests
  std::string action;  ///< what to do, in the imperative, with the procedure that does it
  Recorded record;
  About about;
  char axis = 0;         ///< of a field experiment along one axis; 0: any other
  bool by_hand = false;  ///< no ready procedure does this and no more
};

/// What a bench can do, at most; by itself the standard procedures' fields and temperatures.
struct BenchReach {
  static constexpr double kStandard_ut = 300.0;
  static constexpr double kStandard_c = 55.0;
  double field_ut = kStandard_ut;  ///< along one axis, either sign; a multiple of 50
  double warmest_c = kStandard_c;
};
/// Of a bench's limits, coil constants and supplies, the ambient field to be nulled allowed for.
BenchReach reach_of(const config::BenchConfig& bench);

/// Where the room and the thermostat stood in the measurement that is to be continued.
struct BenchState {
  double ambient_c = 21.0;
  double held_c = 21.0;     ///< where the thermostat held it; as the room: heaters off
  std::string moving_axes;  ///< "xz": axes along which a field was varied
  BenchReach reach;
};

/// In a fixed order, whatever the effects in question are: all of them that the bench can do.
std::vector<Experiment> bench_experiments(const BenchState& state);

}  // namespace fogbench::model
