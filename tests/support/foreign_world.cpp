#include "tests/support/foreign_world.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace fogbench::tests {
namespace {

using Field = std::array<double, 3>;

/// Grows a run step by step.
class Schedule {
 public:
  void step() {
    // Boost heating of 45 degC/h until 2 degC below the target, then an exponential approach of
    // 8 min; free cooling at 25 degC/h at most. The heat capacity smooths the rate over 60 s.
    const double missing = target_c_ - temperature_;
    const double wanted = std::max(missing > 2.0 ? 45.0 : missing * 3600.0 / 480.0, -25.0);
    rate_ += (wanted - rate_) * (1.0 - std::exp(-kGridStep / 60.0));
    temperature_ += rate_ * kGridStep / 3600.0;
    const double ambient =
        kLaboratory +
        0.5 * std::sin(2.0 * std::numbers::pi * World::time_s(world_.size()) / 9000.0 + 1.0);
    const double heater = std::clamp(0.22 * (temperature_ - ambient) + 0.22 * rate_, 0.0, 12.0);
    gradient_ += (0.06 * heater + 0.01 * rate_ - gradient_) * (1.0 - std::exp(-kGridStep / 240.0));
    world_.temperature_c.push_back(temperature_);
    world_.rate_c_per_h.push_back(rate_);
    world_.ambient_c.push_back(ambient);
    world_.heater_w.push_back(heater);
    world_.gradient_c.push_back(gradient_);
    world_.azimuth_deg.push_back(azimuth_deg_);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      world_.field_ut[axis].push_back(field_ut_[axis]);
    }
  }

  void pass(double seconds) {
    for (double s = 0.0; s < seconds; s += kGridStep) step();
  }

  void window(double seconds, const std::string& segment) {
    const std::size_t begin = world_.size();
    pass(seconds);
    world_.windows.push_back({begin, world_.size(), segment});
  }

  /// Windows of a minute without a gap: the transients are kept.
  void hold(double target_c, int minutes, const std::string& segment) {
    target_c_ = target_c;
    for (int i = 0; i < minutes; ++i) window(60.0, segment);
  }

  void turn_to(double azimuth_deg) {
    azimuth_deg_ = azimuth_deg;
    pass(120.0);
  }

  /// 0 -> 300 -> -300 -> 0 uT along `along`: 25 windows of 180 s, 20 s after each step.
  void sweep(const Field& along, const std::string& name) {
    const auto at = [&](double level_ut, const std::string& branch) {
      for (std::size_t axis = 0; axis < 3; ++axis) field_ut_[axis] = level_ut * along[axis];
      pass(20.0);
      window(180.0, name + "/" + branch);
    };
    for (int level = 0; level <= 6; ++level) at(50.0 * level, "up");
    for (int level = 5; level >= -6; --level) at(50.0 * level, "down");
    for (int level = -5; level <= 0; ++level) at(50.0 * level, "return");
  }

  void three_axes() {
    turn_to(0.0);
    sweep({1.0, 0.0, 0.0}, "coil_x");
    sweep({0.0, 1.0, 0.0}, "coil_y");
    turn_to(90.0);
    sweep({0.0, 0.0, 1.0}, "coil_z");
  }

  World finish() { return std::move(world_); }

 private:
  World world_;
  double temperature_ = kLaboratory, rate_ = 0.0, gradient_ = 0.0;
  double target_c_ = kLaboratory, azimuth_deg_ = 0.0;
  Field field_ut_{};
};

constexpr double kHeating[] = {31.0, 35.0, 40.0, 45.0, 50.0, 55.0};

void heat(Schedule& schedule, int minutes) {
  schedule.hold(kLaboratory, 10, "thermostat/baseline");
  for (const double target : kHeating) schedule.hold(target, minutes, "thermostat/up");
}

void plateaus(Schedule& schedule) {
  for (const double target : kHeating) {
    schedule.hold(target, 0, "");
    schedule.pass(2400.0);
    for (int i = 0; i < 3; ++i) schedule.window(60.0, "thermostat/up");
  }
}

void turntable(Schedule& schedule) {
  for (const int turn : {0, 1, 2, 3, 4, 5, 6, 5, 4, 3, 2, 1, 0}) {
    schedule.turn_to(60.0 * turn);
    for (int i = 0; i < 6; ++i) schedule.window(60.0, "turntable");
  }
}

World make_run(Design design) {
  Schedule s;
  switch (design) {
    case Design::kMagnetic:
    case Design::kTwoRuns:
      s.three_axes();
      break;
    case Design::kDiagonals: {
      s.three_axes();
      const double half = std::numbers::sqrt2 / 2.0;
      s.sweep({half, half, 0.0}, "coil_xy");
      s.sweep({0.0, half, half}, "coil_yz");
      s.sweep({half, 0.0, half}, "coil_zx");
      break;
    }
    case Design::kOneAxis:
      s.sweep({0.0, 0.0, 1.0}, "coil_z");
      break;
    case Design::kPlateaus:
      plateaus(s);
      break;
    case Design::kThermal:
      heat(s, 60);
      break;
    case Design::kThermalCooling:
      heat(s, 60);
      for (const double target : {45.0, 35.0, 25.0}) s.hold(target, 60, "thermostat/down");
      break;
    case Design::kTurntable:
      turntable(s);
      break;
    case Design::kMixed:
      heat(s, 40);
      s.three_axes();
      s.hold(35.0, 60, "thermostat/down");
      s.three_axes();
      break;
    case Design::kLong:
      s.three_axes();
      for (const double plateau : {55.0, 40.0}) {
        heat(s, 60);
        for (const double target : {45.0, 35.0, 25.0}) s.hold(target, 60, "thermostat/down");
        s.hold(plateau, 60, "thermostat/up");
        s.three_axes();
      }
      break;
  }
  return s.finish();
}

}  // namespace

std::string name_of(Design design) {
  switch (design) {
    case Design::kMagnetic:
      return "magnetic";
    case Design::kDiagonals:
      return "diagonals";
    case Design::kOneAxis:
      return "one_axis";
    case Design::kPlateaus:
      return "plateaus";
    case Design::kThermal:
      return "thermal";
    case Design::kThermalCooling:
      return "cooling";
    case Design::kTurntable:
      return "turntable";
    case Design::kMixed:
      return "mixed";
    case Design::kLong:
      return "long";
    case Design::kTwoRuns:
      return "two_runs";
  }
  return {};
}

std::vector<Design> all_designs() {
  return {Design::kMagnetic, Design::kDiagonals,      Design::kOneAxis,   Design::kPlateaus,
          Design::kThermal,  Design::kThermalCooling, Design::kTurntable, Design::kMixed,
          Design::kLong,     Design::kTwoRuns};
}

double World::mean(const Series& series, const Window& window) const {
  const auto from = series.begin() + static_cast<std::ptrdiff_t>(window.begin);
  const auto to = series.begin() + static_cast<std::ptrdiff_t>(window.end);
  return std::accumulate(from, to, 0.0) / static_cast<double>(window.end - window.begin);
}

std::vector<World> make_worlds(Design design) {
  std::vector<World> runs{make_run(design)};
  if (design == Design::kTwoRuns) runs.push_back(make_run(design));
  return runs;
}

}  // namespace fogbench::tests
