#pragma once
// The first half of a simulator that shares nothing with model/ and simulator/: what truly happens
// to a gyro on a bench during an experiment, on a grid of 10 s, and where the averaging windows
// lie. Everything here is certain; noise and instruments come later (foreign_bench.hpp).

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace fogbench::tests {

using Series = std::vector<double>;  ///< one value a grid step

inline constexpr double kGridStep = 10.0;    ///< s
inline constexpr double kLaboratory = 21.0;  ///< degC; also the models' reference temperature
inline constexpr double kFieldUnit = 100.0;  ///< uT; fields enter every effect in it

enum class Design {
  kMagnetic,        ///< three axes, 0 -> 300 -> -300 -> 0 uT, 180 s windows: 75 rows
  kDiagonals,       ///< the same and sweeps of two axes together: 150 rows
  kOneAxis,         ///< z alone: 25 rows
  kPlateaus,        ///< three settled windows at each of six temperatures: 18 rows
  kThermal,         ///< baseline and six plateaus with their ramps, heating only: 370 rows
  kThermalCooling,  ///< the same with a cooling branch: 550 rows
  kTurntable,       ///< a turn of 60 deg seven times, there and back: 78 rows
  kMixed,           ///< thermal steps, then the three axes at two temperatures: 460 rows
  kLong,            ///< two thermal cycles with the three axes at three temperatures: 1,445 rows
  kTwoRuns,         ///< the magnetic test twice, power off between: 150 rows
};

/// "magnetic", "two_runs"...
std::string name_of(Design design);
/// Every design, in order.
std::vector<Design> all_designs();

/// One run: from power-on to power-off.
struct World {
  struct Window {
    std::size_t begin, end;  ///< grid steps
    std::string segment;
    double seconds() const { return static_cast<double>(end - begin) * kGridStep; }
  };

  Series temperature_c, rate_c_per_h, gradient_c, heater_w, ambient_c, azimuth_deg;
  std::array<Series, 3> field_ut;
  std::vector<Window> windows;  ///< in time order, never overlapping

  std::size_t size() const { return temperature_c.size(); }
  /// Middle of a step, s since power-on.
  static double time_s(std::size_t step) { return (static_cast<double>(step) + 0.5) * kGridStep; }
  double mean(const Series& series, const Window& window) const;
};

/// The runs of the experiment. Nothing is random.
std::vector<World> make_worlds(Design design);

}  // namespace fogbench::tests
