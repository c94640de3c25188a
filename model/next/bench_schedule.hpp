#pragma once
// A bench that exists only as numbers: what its signals would read while a schedule of heating,
// fields and rotations is carried out. Coarse on purpose: it has to say which signals move, when
// and roughly how far, so that experiments can be weighed before anybody carries them out.
//
//   P = clamp(G (set - ambient) + gain (set - T), 0, P_max),  tau dA/dt = P - A
//   C dT/dt = A - G (T - ambient),  gradient = sum of r A, with an r for each heater
//   ambient = mean + a slow wander

#include <string>
#include <vector>

#include "model/noise/noise.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// What a schedule recorded: the measurement table (without the gyro's rate), the windows of its
/// rows, and the time on the bench, power-on to end.
struct Recorded {
  Table table;
  Windows windows;
  double hours = 0.0;
};

enum class Heater { kOff, kNormal, kBoost };

class BenchSchedule {
 public:
  /// Starts at power-on, at the room's temperature, at azimuth 0, without field.
  explicit BenchSchedule(double ambient_c);

  void heat(Heater heater, double set_c = 0.0);
  /// axis: 'x', 'y' or 'z' of the gyro.
  void field(char axis, double field_ut);
  /// Fields off, then the rotation; not recorded.
  void turn(double azimuth_deg);
  /// Not recorded.
  void wait(double seconds);
  /// Windows of `window_s`, one after the other.
  void record(double seconds, double window_s, const std::string& segment);
  /// Until the temperature has stayed within 0.1 degC of the set point for five minutes; recorded
  /// in windows of `window_s`, or not where that is 0.
  void settle(double window_s, const std::string& segment);
  /// Heaters off and recording until the temperature has fallen to `temperature_c`.
  void cool_to(double temperature_c, double window_s, const std::string& segment);
  /// Each level averaged in `windows` windows of `window_s`, after a settling time of 5 s.
  void sweep(char axis, const std::vector<double>& levels_ut, double window_s, int windows = 1);

  double time_s() const { return state_.time_s; }
  Recorded recorded() const;

 private:
  struct State {
    double time_s = 0.0, temperature_c = 0.0, rate_c_per_h = 0.0, gradient_c = 0.0;
    double heater_w = 0.0, ambient_c = 0.0;
  };
  struct Row {
    double centre_s, duration_s;
    State mean;
    double field_ut[3];
    double azimuth_deg;
    std::string segment;
  };
  void advance(double step_s);
  bool at_rest() const;

  double mean_ambient_c_;
  State state_;
  double arriving_w_ = 0.0, arriving_boost_w_ = 0.0;
  Heater heater_ = Heater::kOff;
  double set_c_ = 0.0;
  double field_ut_[3] = {0.0, 0.0, 0.0};
  double azimuth_deg_ = 0.0;
  std::vector<Row> rows_;
};

}  // namespace fogbench::model
