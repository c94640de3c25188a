#include "model/next/experiments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

namespace fogbench::model {
namespace {

constexpr Experiment::About kRest;
constexpr Experiment::About kField{.field = true};
constexpr Experiment::About kThermal{.temperature = true};
constexpr Experiment::About kAzimuth{.azimuth = true};

// Before any measurement: the gyro's own warm-up, 40 min.
constexpr double kWarmUp_s = 2400.0;
constexpr double kFieldAverage_s = 180.0;
constexpr double kPlateauAverage_s = 60.0;
constexpr double kTransient_s = 60.0;
constexpr double kFieldStep_ut = 50.0;
constexpr std::array<double, 6> kSetPoints_c = {31, 35, 40, 45, 50, 55};
// Less far above the room a thermal experiment shows little, and its set points are few.
constexpr double kLeastWarmest_c = 45.0;

/// 0, up to the end, down to the other end, and back.
std::vector<double> sweep_levels(double end_ut, double step_ut) {
  std::vector<double> levels;
  for (double h = 0; h <= end_ut; h += step_ut) levels.push_back(h);
  for (double h = levels.back() - step_ut; h >= -end_ut; h -= step_ut) levels.push_back(h);
  for (double h = levels.back() + step_ut; h <= 0; h += step_ut) levels.push_back(h);
  return levels;
}

/// What a procedure is told where its own levels are beyond this bench: " with levels_ut 0, 50
/// ...".
std::string levels_told(const BenchState& state, const char* joint) {
  if (state.reach.field_ut == BenchReach::kStandard_ut) return "";
  return fmt::format("{}levels_ut 0, 50 ... {:g} ... -{:g} ... 0", joint, state.reach.field_ut,
                     state.reach.field_ut);
}

/// Those of the values that the bench reaches.
template <class Values>
std::vector<double> within(const Values& values, double most) {
  std::vector<double> out;
  std::copy_if(values.begin(), values.end(), std::back_inserter(out),
               [&](double value) { return std::abs(value) <= most; });
  return out;
}

std::vector<double> negated(std::vector<double> levels) {
  for (double& level : levels) level = -level;
  return levels;
}

/// The vertical pair drives OX at any azimuth; the horizontal one OY at 0 deg, OZ at 90 deg.
double azimuth_for(char axis) {
  return axis == 'z' ? 90.0 : 0.0;
}

BenchSchedule warm(const BenchState& state, double held_c) {
  BenchSchedule bench(state.ambient_c);
  if (held_c > state.ambient_c) {
    bench.heat(Heater::kNormal, held_c);
    bench.settle(0.0, "");
  }
  bench.wait(kWarmUp_s - bench.time_s());
  return bench;
}

/// Ready for a sweep.
BenchSchedule warm_at(const BenchState& state, char axis, double held_c) {
  BenchSchedule bench = warm(state, held_c);
  if (azimuth_for(axis) != 0.0) bench.turn(azimuth_for(axis));
  bench.record(kFieldAverage_s, kFieldAverage_s, "coil/baseline");
  return bench;
}

class List {
 public:
  void add(std::string key, std::string action, const BenchSchedule& bench,
           const Experiment::About& about, char axis = 0, bool by_hand = false) {
    experiments.push_back(
        {std::move(key), std::move(action), bench.recorded(), about, axis, by_hand});
  }
  std::vector<Experiment> experiments;
};

void add_field_experiments(List& list, const BenchState& state, char axis) {
  const std::string letter(1, axis);
  const std::string name(1, static_cast<char>(axis - 'x' + 'X'));
  const double end = state.reach.field_ut;
  const auto levels = sweep_levels(end, kFieldStep_ut);
  {
    BenchSchedule bench = warm_at(state, axis, state.held_c);
    bench.sweep(axis, levels, kFieldAverage_s);
    list.add("sweep_" + letter,
             fmt::format("sweep O{} (coil-sweep{})", name, levels_told(state, " with ")), bench,
             kField, axis);
  }
  {
    BenchSchedule bench = warm_at(state, axis, state.held_c);
    for (const double level : {end, 0.0, -end, 0.0}) {
      bench.field(axis, level);
      bench.wait(5.0);
      bench.record(1800.0, kFieldAverage_s, "coil_" + letter + "/hold");
    }
    list.add("hold_" + letter,
             fmt::format("hold +{1:g} and -{1:g} uT along O{0} for half an hour each, with half an "
                         "hour at zero after each (a sweep of levels_ut {1:g}, 0, -{1:g}, 0, each "
                         "ten times, average_s 180)",
                         name, end),
             bench, kField, axis);
  }
  {
    BenchSchedule bench = warm_at(state, axis, state.held_c);
    bench.sweep(axis, sweep_levels(end, 100.0), kFieldAverage_s / 2.0, 2);
    list.add("two_windows_" + letter,
             fmt::format("sweep O{} in steps of 100 uT with two windows in each point, early and "
                         "late (each level twice in levels_ut, average_s 90)",
                         name),
             bench, kField, axis);
  }
  {
    BenchSchedule bench = warm_at(state, axis, state.held_c);
    bench.sweep(axis, {0, end, 0, -end, 0}, 30.0, 20);
    list.add("dwell_" + letter,
             fmt::format("step O{0} between 0, +{1:g} and -{1:g} uT and stay ten minutes at each "
                         "level, in windows of 30 s (each level twenty times in levels_ut, "
                         "average_s 30)",
                         name, end),
             bench, kField, axis);
  }
  {
    BenchSchedule bench = warm_at(state, axis, state.held_c);
    std::vector<double> loops;
    for (const double share : {1.0, 2.0, 3.0}) {
      for (const double part : {0.0, 0.5, 1.0, 0.5, 0.0, -0.5, -1.0, -0.5, 0.0}) {
        loops.push_back(end * share / 3.0 * part);
      }
    }
    bench.sweep(axis, loops, kFieldAverage_s);
    list.add(
        "minor_loops_" + letter,
        fmt::format("sweep O{} in small and large loops, with end fields of {:.4g}, {:.4g} and "
                    "{:g} uT (coil-sweep with levels_ut {:.4g} ...)",
                    name, end / 3.0, end / 1.5, end, fmt::join(std::span(loops).first(9), ", ")),
        bench, kField, axis);
  }
  {
    const double second_c = state.held_c < 38.0 ? std::min(45.0, state.reach.warmest_c) : 31.0;
    BenchSchedule bench = warm_at(state, axis, second_c);
    bench.sweep(axis, levels, kFieldAverage_s);
    list.add("second_temperature_" + letter,
             fmt::format("repeat the sweep of O{} at a second thermostat temperature, {:g} degC "
                         "(second-temperature with second_c {:g}{})",
                         name, second_c, second_c, levels_told(state, " and ")),
             bench, kField, axis);
  }
  {
    BenchSchedule bench = warm_at(state, axis, state.held_c);
    const auto ramp = sweep_levels(end, end / 2.0);
    bench.sweep(axis, ramp, 60.0);
    bench.heat(Heater::kBoost, state.reach.warmest_c);
    bench.sweep(axis, ramp, 60.0);
    bench.heat(Heater::kOff);
    bench.sweep(axis, ramp, 60.0);
    list.add(
        "ramp_" + letter,
        fmt::format("sweep O{} at rest, while the boost heaters warm the gyro towards {:g} degC, "
                    "and while it cools (field-on-ramp{})",
                    name, state.reach.warmest_c, levels_told(state, " with ")),
        bench, {.field = true, .temperature = true, .together = true}, axis);
  }
}

void add_cross_experiments(List& list, const BenchState& state) {
  struct Pair {
    const char* axes;
    double azimuth_deg;
    const char* how;
  };
  // Between OY and OZ the horizontal field is shared out by standing at 45 deg.
  for (const Pair& pair : {Pair{"xy", 0.0, "at azimuth 0, both coil pairs"},
                           Pair{"zx", 90.0, "at azimuth 90, both coil pairs"},
                           Pair{"yz", 45.0, "at azimuth 45 and 135 the horizontal pair"}}) {
    BenchSchedule bench = warm(state, state.held_c);
    const bool shared = pair.azimuth_deg == 45.0;
    if (pair.azimuth_deg != 0.0) bench.turn(pair.azimuth_deg);
    const double each_ut = std::min(200.0, state.reach.field_ut);
    const auto point = [&](double a, double b) {
      bench.field(pair.axes[0], each_ut * a);
      bench.field(pair.axes[1], each_ut * b);
      bench.wait(5.0);
      bench.record(kFieldAverage_s, kFieldAverage_s, std::string("coil_") + pair.axes + "/both");
    };
    for (const double sign : {1.0, -1.0}) {
      point(0, 0), point(sign, sign), point(0, 0), point(-sign, -sign);
      if (!shared) point(0, 0), point(sign, -sign), point(0, 0), point(-sign, sign);
    }
    if (shared) {
      bench.turn(135.0);
      for (const double sign : {1.0, -1.0}) {
        point(0, 0), point(sign, -sign), point(0, 0), point(-sign, sign);
      }
    }
    list.add(std::string("together_") + pair.axes,
             fmt::format("energise O{} and O{} together with {:g} uT each at the four sign "
                         "combinations, with zeros between ({}; two-axes does it for all pairs)",
                         static_cast<char>(pair.axes[0] - 'x' + 'X'),
                         static_cast<char>(pair.axes[1] - 'x' + 'X'), each_ut, pair.how),
             bench, kField, 0, true);
  }
}

void add_reversed_order(List& list, const BenchState& state) {
  BenchSchedule bench = warm(state, state.held_c);
  bench.turn(90.0);
  bench.record(kFieldAverage_s, kFieldAverage_s, "coil/baseline");
  const auto levels = negated(sweep_levels(state.reach.field_ut, kFieldStep_ut));
  const auto moves = [&](char axis) { return state.moving_axes.find(axis) != std::string::npos; };
  if (moves('z')) bench.sweep('z', levels, kFieldAverage_s);
  bench.record(1800.0, kFieldAverage_s, "coil/baseline");
  bench.turn(0.0);
  bench.record(1800.0, kFieldAverage_s, "coil/baseline");
  for (const char axis : {'y', 'x'}) {
    if (moves(axis)) bench.sweep(axis, levels, kFieldAverage_s);
  }
  list.add("reversed",
           fmt::format("repeat the run in reverse order: azimuth 90 first, the last axis first, "
                       "levels from -{:g} uT (coil-sweep with its steps turned round and levels_ut "
                       "negated)",
                       state.reach.field_ut),
           bench, {.field = true, .azimuth = true});
}

void add_plateaus(BenchSchedule& bench, std::span<const double> set_points_c, double transient_s,
                  int averages) {
  for (const double target_c : set_points_c) {
    bench.heat(Heater::kBoost, target_c);
    bench.settle(transient_s, "thermostat/heating");
    bench.heat(Heater::kNormal, target_c);
    bench.record(averages * kPlateauAverage_s, kPlateauAverage_s, "thermostat/plateau");
  }
}

void add_thermal_experiments(List& list, const BenchState& state) {
  const double warmest_c = state.reach.warmest_c;
  const auto set_points = within(kSetPoints_c, warmest_c);
  const bool standard = set_points.size() == kSetPoints_c.size();
  const std::string told =
      standard ? "" : fmt::format(" with set_points_c {}", fmt::join(set_points, ", "));
  {
    BenchSchedule bench(state.ambient_c);
    add_plateaus(bench, set_points, kTransient_s, 3);
    list.add("thermostat_steps",
             fmt::format("step the thermostat through its set points (thermostat-steps{})", told),
             bench, kThermal);
  }
  {
    BenchSchedule bench = warm(state, state.held_c);
    add_plateaus(bench, set_points, kTransient_s, 3);
    for (auto target = set_points.rbegin() + 1; target != set_points.rend(); ++target) {
      bench.cool_to(*target, kTransient_s, "thermostat/cooling");
      bench.heat(Heater::kNormal, *target);
      bench.settle(kTransient_s, "thermostat/cooling");
      bench.record(3.0 * kPlateauAverage_s, kPlateauAverage_s, "thermostat/cooling_plateau");
    }
    list.add("cooling_branch",
             fmt::format("add a cooling branch (thermostat-steps{} cooling_c {})",
                         standard ? " with" : told + " and",
                         fmt::join(set_points.rbegin() + 1, set_points.rend(), ", ")),
             bench, kThermal);
  }
  {
    BenchSchedule bench = warm(state, state.held_c);
    std::vector<double> grid;
    for (double t = 31.0; t <= warmest_c; t += 1.0) grid.push_back(t);
    add_plateaus(bench, grid, kTransient_s, 3);
    list.add("fine_grid",
             fmt::format("step the temperature by 1 degC (thermostat-steps with set_points_c 31, "
                         "32, 33 ... {:g})",
                         grid.back()),
             bench, kThermal);
  }
  {
    BenchSchedule bench(state.ambient_c);
    add_plateaus(bench, std::array{31.0, 45.0}, kTransient_s, 3);
    bench.cool_to(31.0, kTransient_s, "thermostat/cooling");
    list.add("short_loop",
             "heat to 45 degC and let it cool to 31 degC again, recording all the way "
             "(thermostat-steps with set_points_c 31, 45 and cooling_c 31)",
             bench, kThermal);
  }
  {
    BenchSchedule bench(state.ambient_c);
    for (int i = 0; i < 3; ++i) {
      bench.heat(Heater::kBoost, warmest_c);
      bench.record(480.0, kTransient_s, "thermostat/boost");
      bench.heat(Heater::kNormal, warmest_c);
      bench.record(480.0, kTransient_s, "thermostat/normal");
    }
    list.add(
        "boost_and_normal",
        fmt::format("heat in one go towards {:g} degC with the boost heaters and the normal one "
                    "by turns, eight minutes each, three times (set_temperature boost and "
                    "normal, wait 480 s in windows of 60 s)",
                    warmest_c),
        bench, kThermal);
  }
  {
    BenchSchedule bench(state.ambient_c);
    const auto targets = within(std::array{31.0, 38.0, 45.0, 52.0}, warmest_c);
    for (const double target_c : targets) {
      bench.heat(Heater::kBoost, target_c);
      bench.settle(10.0, "thermostat/heating");
    }
    list.add("edges",
             fmt::format("record the edges of quick temperature steps in windows of 10 s "
                         "(thermostat-steps with set_points_c {} and transient_s 10)",
                         fmt::join(targets, ", ")),
             bench, kThermal);
  }
  {
    BenchSchedule bench(state.ambient_c);
    bench.heat(Heater::kBoost, 45.0);
    bench.settle(0.0, "");
    bench.heat(Heater::kNormal, 45.0);
    bench.wait(600.0);
    for (int i = 0; i < 10; ++i) {
      bench.heat(Heater::kNormal, 45.0);
      bench.record(180.0, 10.0, "thermostat/on");
      bench.heat(Heater::kOff);
      bench.record(60.0, 10.0, "thermostat/off");
    }
    list.add("heater_off",
             "switch the heater off for 60 s at a constant 45 degC, ten times (heater-off)", bench,
             kThermal);
  }
}

void add_experiments_at_rest(List& list, const BenchState& state) {
  {
    BenchSchedule bench = warm(state, state.held_c);
    for (const double azimuth : {0.0, 90.0, 180.0, 270.0, 0.0}) {
      bench.turn(azimuth);
      bench.record(300.0, 60.0, "azimuth");
    }
    list.add("azimuths",
             "stand at further azimuths without field, five minutes each at 0, 90, 180, "
             "270 and 0 deg (azimuths)",
             bench, kAzimuth);
  }
  {
    BenchSchedule bench(state.ambient_c);
    bench.record(2.0 * 3600.0, 60.0, "static");
    list.add("cold_start",
             "start cold and record from power-on, two hours at rest (static-record "
             "with duration_s 7200, at once)",
             bench, kRest);
  }
  for (const int hours : {1, 4, 12}) {
    BenchSchedule bench = warm(state, state.held_c);
    bench.record(hours * 3600.0, 180.0, "static");
    list.add(fmt::format("rest_{}h", hours),
             fmt::format("record {} h at rest (static-record with "
                         "duration_s {})",
                         hours, hours * 3600),
             bench, kRest);
  }
}

}  // namespace

BenchReach reach_of(const config::BenchConfig& bench) {
  double field_ut = bench.limits.field_maximum.value;
  for (const config::CoilConfig* coil : {&bench.coil_horizontal, &bench.coil_vertical}) {
    field_ut = std::min(field_ut, coil->current_limit.value * coil->field_ut_per_a -
                                      bench.limits.compensation_maximum.value);
  }
  const double steps = std::floor(std::max(field_ut, 0.0) / kFieldStep_ut);
  return {std::min(BenchReach::kStandard_ut, steps * kFieldStep_ut),
          std::min(BenchReach::kStandard_c, bench.limits.temperature_maximum.value)};
}

std::vector<Experiment> bench_experiments(const BenchState& state) {
  List list;
  if (state.reach.field_ut >= kFieldStep_ut) {
    for (const char axis : {'x', 'y', 'z'}) add_field_experiments(list, state, axis);
    add_cross_experiments(list, state);
    add_reversed_order(list, state);
  }
  if (state.reach.warmest_c >= kLeastWarmest_c) add_thermal_experiments(list, state);
  add_experiments_at_rest(list, state);
  return std::move(list.experiments);
}

}  // namespace fogbench::model
