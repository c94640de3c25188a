#pragma once
// What the run engine reports, and to whom. The run log implements Recorder: when a call returns
// success, the thing is on disk (gyro samples: handed to the chunk writer, on disk within a chunk).

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/instruments.hpp"

namespace fogbench::procedures {

/// A run that takes up another one, which was interrupted, where that one stopped.
struct Continuation {
  /// Points that are measured anew: those of `run` at or after `from_s`.
  struct Repeated {
    std::int64_t run = 0;
    double from_s = 0.0;
  };
  std::int64_t run = 0;    ///< the one that is taken up
  std::string first_step;  ///< path of the first step that is left of it
  std::vector<Repeated> repeated;
  std::size_t points = 0;  ///< that are measured already, and not anew
  std::string says;        ///< for the record
  std::string data_json;
};

/// Everything that made the run, stored with it.
struct RunHeader {
  /// A channel that an auxiliary sensor of the bench adds to the record.
  struct Auxiliary {
    std::string name, meaning;
  };
  std::string procedure;
  std::string procedure_json;  ///< the exact files' texts
  std::string bench;
  std::string bench_json;
  std::string scenario_json;  ///< empty on a real bench
  std::optional<std::uint64_t> seed;
  std::string gyro_serial_number;
  std::string operator_name;
  std::string software_version;
  std::string started_at;  ///< ISO 8601, UTC
  double frame_rate_hz = 0.0;
  double reference_rate_deg_per_h = 0.0;
  std::optional<Continuation> continues;
  std::vector<Auxiliary> auxiliary;  ///< of a run that is read: empty, its points name them
  /// Of the gyro before the first step, each an event: since when it operates, and how that is
  /// known. Empty in a run that is read.
  std::vector<std::string> remarks;
  std::string question;  ///< put to the operator before the first step; empty: none
};

/// An instrument as it identified itself, with its certificate.
struct InstrumentRecord {
  std::string role;
  std::string identity;
  std::string serial_number;
  std::string calibrated_on;
  std::string calibration_due;
};

enum class PointKind { kBaseline, kAverage, kTransient };
/// As the run log and the exports spell it.
constexpr std::string_view name_of(PointKind kind) {
  switch (kind) {
    case PointKind::kBaseline:
      return "baseline";
    case PointKind::kAverage:
      return "average";
    case PointKind::kTransient:
      return "transient";
  }
  return "";
}

/// What auxiliary sensors say, by channel, in the units of the names. NaN is missing.
using AuxiliaryValues = std::map<std::string, double, std::less<>>;

/// One averaged measurement. Missing quantities are NaN. Times are since the gyro's power-on.
struct Point {
  PointKind kind = PointKind::kAverage;
  int test = 1;
  int block = 0;  ///< of the indivisible block that it belongs to; 0 is none
  std::string segment;
  double time_s = 0.0;  ///< centre of the window
  double duration_s = 0.0;
  double rate_deg_per_h = 0.0;            ///< mean, reference rate subtracted
  double rate_std_deg_per_h = 0.0;        ///< scatter of the samples
  double rate_std_error_deg_per_h = 0.0;  ///< scatter / sqrt(count): white noise only
  std::uint64_t count = 0;                ///< good frames in the window
  std::uint64_t dropped = 0;              ///< frames missing, bad or invalid in the window
  double temperature_c = 0.0;             ///< mean of the working sensors
  double temperature_start_c = 0.0;       ///< at the window's ends, freed of the sensors' lag
  double temperature_end_c = 0.0;
  double temperature_rate_c_per_h = 0.0;  ///< mean over the window
  double temperature_gradient_c = 0.0;    ///< working 1 - working 2
  double temperature_control_c = 0.0;
  double target_c = 0.0;
  double ambient_c = 0.0;
  double heater_w = 0.0;
  double field_x_ut = 0.0, field_y_ut = 0.0, field_z_ut = 0.0;  ///< measured
  double field_set_ut = 0.0;    ///< commanded level; NaN outside a sweep
  double coil_current_a = 0.0;  ///< of the energised pair
  double current_horizontal_a = 0.0,
         current_vertical_a = 0.0;  ///< measured, with what nulls the ambient field
  double azimuth_deg = 0.0;
  AuxiliaryValues auxiliary;  ///< means over the window
};

/// Slow quantities, read about once a second.
struct MonitorRow {
  double time_s = 0.0;
  drivers::ThermostatReading thermostat;
  drivers::FieldReading field;
  double current_horizontal_a = 0.0, current_vertical_a = 0.0;
  double azimuth_deg = 0.0;
  AuxiliaryValues auxiliary;
};

/// A run ends as one of the first three. The last is written when nobody ended it and another run
/// takes it up, or a person gives it up.
enum class RunOutcome { kCompleted, kAborted, kFailed, kInterrupted };
/// As the run log and the exports spell it.
constexpr std::string_view name_of(RunOutcome outcome) {
  switch (outcome) {
    case RunOutcome::kCompleted:
      return "completed";
    case RunOutcome::kAborted:
      return "aborted";
    case RunOutcome::kFailed:
      return "failed";
    case RunOutcome::kInterrupted:
      return "interrupted";
  }
  return "";
}

struct RunEnd {
  RunOutcome outcome = RunOutcome::kCompleted;
  std::string reason;
  bool safe_state_reached = false;
  std::string ended_at;
  drivers::StreamStatistics stream;
};

class Recorder {
 public:
  virtual ~Recorder() = default;
  /// Returns the run's number.
  virtual Result<std::int64_t> begin_run(const RunHeader& header,
                                         const std::vector<InstrumentRecord>& instruments) = 0;
  /// `path` numbers the step within the expanded plan, "3" or "3.2".
  virtual Status step_started(const std::string& path, const std::string& what, double time_s) = 0;
  virtual Status step_ended(const std::string& path, double time_s,
                            const std::string& evidence) = 0;
  /// severity: info, warning, error. `data_json` is the evidence, may be empty.
  virtual Status event(double time_s, const std::string& severity, const std::string& message,
                       const std::string& data_json) = 0;
  virtual Status point(const Point& point) = 0;
  /// An indivisible block was interrupted and restarts from its first step: every point recorded
  /// for it so far stays on record but is void, and takes no part in results or exports.
  virtual Status void_block(int block, double time_s, const std::string& reason) = 0;
  virtual Status monitor(const MonitorRow& row) = 0;
  virtual Status gyro_samples(const drivers::GyroBlock& block) = 0;
  virtual Status end_run(const RunEnd& end) = 0;
};

}  // namespace fogbench::procedures
