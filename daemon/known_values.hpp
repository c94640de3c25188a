#pragma once
// What was read last of every slow quantity, for those that are missing now.

#include <map>
#include <string_view>
#include <vector>

#include "procedures/recorder.hpp"

namespace fogbench::daemon {

/// The last reading of a quantity that was not missing.
struct KnownValue {
  std::string name;  ///< the channel's
  double value = 0.0;
  double time_s = 0.0;  ///< since power-on
};

class KnownValues {
 public:
  /// Those that are missing in this row and were not before.
  std::vector<KnownValue> missing(const procedures::MonitorRow& row);

 private:
  std::map<std::string, KnownValue, std::less<>> last_;
};

}  // namespace fogbench::daemon
