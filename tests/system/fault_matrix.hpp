#pragma once
// One short run on the simulated bench with one fault, through the real drivers, the run engine and
// the daemon's desk, on the virtual clock; and what it came to.

#include <optional>
#include <string>

#include "config/bench.hpp"
#include "config/scenario.hpp"
#include "procedures/run_engine.hpp"
#include "tests/support/memory_recorder.hpp"

namespace fogbench::system_test {

struct Trial {
  bool opened = false;
  std::string open_error;
  procedures::RunSummary summary;
  test::MemoryRecorder log;
  /// Bench time when the safe state had been tried, since power-on.
  double ended_s = 0.0;
};

/// The ready bench, without lifts and cars: every run is to be the same but for its fault.
config::BenchConfig quiet_bench();

/// Every instrument takes part: heat, average, null the field, sweep OX, turn, null, sweep OZ,
/// heaters off, average. About three minutes of bench time.
Trial run_with(const std::optional<config::FaultSpec>& fault,
               const config::BenchConfig& bench = quiet_bench());

/// How far a point may be from the truth that this bench has; the first point that is further, in a
/// sentence. Empty when all are right.
std::string wrong_point(const Trial& trial);

}  // namespace fogbench::system_test
