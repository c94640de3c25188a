#include "daemon/known_values.hpp"

#include <cmath>

#include "procedures/channel_values.hpp"

namespace fogbench::daemon {

std::vector<KnownValue> KnownValues::missing(const procedures::MonitorRow& row) {
  std::vector<KnownValue> missing;
  procedures::for_each_value(row, [&](std::string_view name, double value) {
    if (std::isfinite(value)) {
      last_[std::string(name)] = {std::string(name), value, row.time_s};
    } else if (const auto known = last_.find(name); known != last_.end()) {
      missing.push_back(known->second);
    }
  });
  return missing;
}

}  // namespace fogbench::daemon
