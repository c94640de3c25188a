#pragma once
// A procedure made ready: parameters bound, loops unrolled, called procedures inlined, limits
// checked and the duration estimated, before anything is touched.

#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "config/bench.hpp"
#include "config/procedure.hpp"
#include "config/result.hpp"

namespace fogbench::procedures {

using config::Axis;
using config::Celsius;
using config::CelsiusPerHour;
using config::Degree;
using config::HeatingMode;
using config::Microtesla;
using config::Parameters;
using config::Seconds;

// The engine's instructions: config's steps with every number resolved.
struct SetTemperature {
  Celsius target;
  HeatingMode mode = HeatingMode::kOff;
};
struct Ramp {
  Celsius to;
  CelsiusPerHour rate;
  HeatingMode mode = HeatingMode::kBoost;  ///< on the way up
  std::string segment;
  Seconds window;
  /// Where the plan expects it to start; the run starts from what it measures.
  Celsius from{0.0};
};
struct SettleTemperature {
  Celsius band;
  Seconds dwell;
  double slope_c_per_h;
  Seconds timeout;
  std::string segment;
  Seconds window;
};
struct Wait {
  Seconds duration;
  Seconds operating_time;
  std::string segment;
  Seconds window;
};
struct Average {
  Seconds duration;
  std::string segment;
  bool baseline = false;
};
struct CompensateField {
  Microtesla tolerance;
};
/// One level of a sweep: field set, settled, averaged.
struct SweepLevel {
  Axis axis;
  Microtesla level;
  Seconds duration;
  Seconds settle;
  std::string segment;
  Microtesla other_pair{0.0};  ///< held by the pair that `axis` does not drive
};
struct Rotate {
  Degree azimuth;
};
struct Prompt {
  std::string text;
};

struct PlannedStep {
  std::variant<SetTemperature, Ramp, SettleTemperature, Wait, Average, CompensateField, SweepLevel,
               Rotate, Prompt>
      action;
  std::string path;   ///< "3.2": place in the procedure; in a loop the middle number is the turn
  std::string where;  ///< "coil-sweep.json: /steps/2", for messages
  std::string says;   ///< a sentence with units, for plan and progress
  int test = 1;
  /// Steps of one indivisible block share its number; 0 is none. After an interruption a block
  /// restarts from its first step.
  int block = 0;
  Seconds estimate{0.0};
  /// Steps of one phase share its number: a step as the procedure has it, a turn of its loop, a
  /// procedure that it calls. `phase_says` is what the turn or the call is; else empty.
  int phase = 0;
  std::string phase_says;
};

struct Plan {
  std::string procedure;
  std::vector<PlannedStep> steps;
  std::vector<std::string> needs;  ///< auxiliary channels without which a point is void
  Seconds estimate{0.0};
  std::vector<std::string> limits_met;  ///< one sentence each: what was checked, and by how much
  std::vector<std::filesystem::path> files;  ///< the procedure's and those of all that it calls
};

/// Errors: kBadInput (unknown parameter, unknown or recursive procedure, wrong type) and kLimit
/// (temperature, field, current, run time outside the bench's), one line with the procedure's file
/// and the step's JSON pointer. `overrides` replace the procedure's parameter defaults.
Result<Plan> make_plan(const config::ProcedureConfig& procedure, const config::BenchConfig& bench,
                       const Parameters& overrides = {});

/// Everything that keeps the procedure from running on this bench, a line each, as far as it can be
/// told at once. Empty when make_plan() makes a plan of it.
std::vector<Error> check_procedure(const config::ProcedureConfig& procedure,
                                   const config::BenchConfig& bench,
                                   const Parameters& overrides = {});

/// The second half of it: sentences, estimates and limits of steps that are expanded already.
Result<Plan> make_plan(const std::string& name, std::vector<PlannedStep> steps,
                       const config::BenchConfig& bench);

}  // namespace fogbench::procedures
