#pragma once
// The procedure language: a closed vocabulary of steps in the field's own words, as data
// (config/procedures/*.json). Checks, expansion and execution are procedures/'s.

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "config/result.hpp"
#include "config/units.hpp"

namespace fogbench::config {

/// A number, or the name of a parameter that stands for one ("$temperature_c").
using Number = std::variant<double, std::string>;
/// {"from": 20, "to": 50, "step": 5}: 20, 25 ... 50; down where `to` lies below `from`. The last is
/// the last one that does not pass `to`.
struct NumberRange {
  Number from = 0.0;
  Number to = 0.0;
  Number step = 1.0;
};

/// A list of numbers, the name of a parameter that holds one ("$levels_ut"), or a range.
using NumberList = std::variant<std::vector<double>, std::string, NumberRange>;

/// A loop or a sweep of more values has gone wrong.
inline constexpr std::size_t kMostValues = 100'000;
/// The numbers of a range. kBadInput, without a place: a step of 0 or less, one that is not finite,
/// more than kMostValues.
Result<std::vector<double>> range_values(double from, double to, double step);

enum class HeatingMode { kOff, kBoost, kNormal };
/// As the run log and the exports spell it.
constexpr std::string_view name_of(HeatingMode mode) {
  switch (mode) {
    case HeatingMode::kOff:
      return "off";
    case HeatingMode::kBoost:
      return "boost";
    case HeatingMode::kNormal:
      return "normal";
  }
  return "";
}
/// What a sweep drives: an axis of the gyro, or north, where the vertical pair points, whatever
/// axes of the gyro lie along it.
enum class Axis { kX, kY, kZ, kNorth };

struct Step;

/// {"step": "set_temperature", "target_c": 31, "mode": "boost"}; mode off needs no target.
struct SetTemperature {
  Number target_c = 0.0;
  HeatingMode mode = HeatingMode::kOff;
};

/// Waits until the temperature has stayed within band_c of the target for dwell_s with a slope
/// below slope_c_per_h; gives up after timeout_s. With a segment, consecutive averages of
/// window_s are recorded under it meanwhile: the transients, from which dT/dt is learned.
struct SettleTemperature {
  Number band_c = 0.1;
  Number dwell_s = 300.0;
  Number slope_c_per_h = 1.0;
  Number timeout_s = 7200.0;
  std::string segment;
  Number window_s = 60.0;
};

/// Moves the target from the present temperature to to_c at rate_c_per_h, and holds it there in
/// normal mode. Upwards with the heaters of `mode`. Records like SettleTemperature when it has a
/// segment. With `settle` it ends as a SettleTemperature of the default criteria does, else when
/// the target has arrived.
struct Ramp {
  Number to_c = 0.0;
  Number rate_c_per_h = 30.0;
  HeatingMode mode = HeatingMode::kBoost;
  bool settle = false;
  std::string segment;
  Number window_s = 60.0;
};

/// Waits until `operating_time_s` have passed since the gyro's power-on, or for `duration_s`.
/// Records like SettleTemperature when it has a segment.
struct Wait {
  Number duration_s = 0.0;
  Number operating_time_s = 0.0;
  std::string segment;
  Number window_s = 60.0;
};

/// One averaged measurement of the gyro with everything else read meanwhile.
struct Average {
  Number duration_s = 60.0;
  std::string segment;
};

/// An average that later points of this test are reported against.
struct Baseline {
  Number duration_s = 60.0;
  std::string segment;
};

/// Nulls the measured field on the two coil axes to within tolerance_ut.
struct CompensateField {
  Number tolerance_ut = 0.2;
};

/// Drives the field along one gyro axis through `levels_ut` from the compensated zero, one average
/// each. Always indivisible: after any interruption it restarts from its first level. Meanwhile the
/// other pair of coils holds other_pair_ut above its own zero.
struct Sweep {
  Axis axis = Axis::kX;
  NumberList levels_ut;
  Number duration_s = 180.0;
  Number settle_s = 5.0;
  std::string segment;  ///< "coil_x"; the branch is appended: /up, /down, /return
  Number other_pair_ut = 0.0;
};

/// Turns the gyro to an azimuth: by motor, or by asking the operator.
struct Rotate {
  Number azimuth_deg = 0.0;
};

/// Asks the operator to do or confirm something.
struct Prompt {
  std::string text;
};

/// What a call gives to a parameter of the procedure that it calls.
using Argument = std::variant<double, std::vector<double>, std::string, NumberRange>;

/// Runs another procedure; `test` marks its points as test 1, 2... `pass` names parameters of it
/// that become the caller's own, with the defaults that they have there.
struct Call {
  std::string procedure;
  std::map<std::string, Argument> parameters;
  std::vector<std::string> pass;
  int test = 0;
};

/// Runs `steps` once for each value of `in`, bound to the parameter `variable`.
struct ForEach {
  std::string variable;
  NumberList in;
  std::vector<Step> steps;
};

/// Runs `steps` so many times.
struct Repeat {
  Number times = 1.0;
  std::vector<Step> steps;
};

/// Restarts from its first step after any interruption.
struct Indivisible {
  std::vector<Step> steps;
};

struct Step {
  std::variant<SetTemperature, Ramp, SettleTemperature, Wait, Average, Baseline, CompensateField,
               Sweep, Rotate, Prompt, Call, ForEach, Repeat, Indivisible>
      action;
  std::string pointer;  ///< JSON pointer of the step, for messages
};

/// A parameter's default: a number or a list of numbers.
using ParameterValue = std::variant<double, std::vector<double>>;

using Parameters = std::map<std::string, ParameterValue>;  ///< by name

struct ProcedureConfig {
  std::string name;
  std::string description;
  Parameters parameters;
  std::vector<std::string> needs;  ///< auxiliary channels without which a point is void
  std::vector<Step> steps;
  std::filesystem::path file;
};

/// Names of the parameters that its calls, in loops and blocks too, pass on to other procedures.
std::vector<std::string> passed_parameters(const ProcedureConfig& procedure);

/// Errors: kBadInput, one line with the file and the JSON pointer.
Result<ProcedureConfig> load_procedure(const std::filesystem::path& file);

/// Reads one into `out`, and everything that is wrong in it, a line each; empty when nothing is.
std::vector<Error> check_procedure_file(const std::filesystem::path& file, ProcedureConfig& out);

}  // namespace fogbench::config
