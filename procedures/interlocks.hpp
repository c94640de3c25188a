#pragma once
// The bench's interlocks over the seconds of a run: which of them trip and clear. Pure: looks at an
// Observation a second, commands nothing; what a trip does is the run session's.
//
//              conditions hold `consecutive` times in a row
//      clear ──────────────────────────────────────────────► tripped
//            ◄──────────────────────────────────────────────
//              at or below the clear threshold, once
//
// Between the two thresholds nothing changes, but the row of violations is broken. A missing value
// neither trips nor clears nor breaks the row, unless the other conditions decide alone.

#include <string>
#include <vector>

#include "config/bench.hpp"
#include "procedures/interlock_gauge.hpp"

namespace fogbench::procedures {

/// An interlock has tripped or cleared.
struct InterlockChange {
  bool tripped = false;
  config::InterlockAction action = config::InterlockAction::kWarn;
  std::string message;
  std::string data_json;  ///< name, state, action, how many in a row, each condition's evidence
};

class Interlocks {
 public:
  explicit Interlocks(const config::BenchConfig& bench);

  std::vector<InterlockChange> observe(const Observation& seen);

  /// Some interlock is violated, and the next seconds decide whether it trips.
  bool undecided() const;
  /// Those that are tripped, with their present values.
  std::vector<std::string> tripped() const;
  std::vector<std::string> tripped(config::InterlockAction action) const;

 private:
  enum class Finding { kViolated, kBetween, kClear, kMissing };
  struct Measured {
    InterlockGauge gauge;
    GaugeReading reading;
    Finding finding = Finding::kMissing;
  };
  struct Interlock {
    config::InterlockConfig config;
    std::vector<Measured> conditions;
    int in_a_row = 0;
    bool tripped = false;
  };
  static Finding finding_of(const config::InterlockCondition& condition, double value);
  static Finding combine(const Interlock& interlock);
  static std::string sentence(const Interlock& interlock);
  static InterlockChange change_of(const Interlock& interlock);

  std::vector<Interlock> interlocks_;
};

}  // namespace fogbench::procedures
