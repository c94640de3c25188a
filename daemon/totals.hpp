#pragma once
// What is counted from the daemon's start on, for its metrics. Nothing here is ever set back.

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "drivers/instruments.hpp"

namespace fogbench::daemon {

using Counts = std::map<std::string, std::uint64_t>;

/// Of the bench; the known names are there from the start, so that a first event is a rise.
struct BenchTotals {
  Counts events{{"info", 0}, {"warning", 0}, {"error", 0}};      ///< by severity
  Counts runs{{"completed", 0}, {"aborted", 0}, {"failed", 0}};  ///< by outcome
  drivers::StreamStatistics stream;  ///< the gyro's, as it was last read
};

/// Of the control socket.
struct ControlTotals {
  double started_unix_s = 0.0;
  std::size_t connections = 0;            ///< open now
  std::uint64_t connections_refused = 0;  ///< one too many
  Counts requests;                        ///< by method; "unknown" for what is none
  Counts refusals;                        ///< by error code
};

}  // namespace fogbench::daemon
