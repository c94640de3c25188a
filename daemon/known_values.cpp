#include "daemon/known_values.hpp"

#include <cmath>

#include "record/store.hpp"

namespace fogbench::daemon {

std::vector<KnownValue> KnownValues::missing(const procedures::MonitorRow& row) {
  std::vector<KnownValue> missing;
  for (const record::MonitorColumn& column : record::monitor_columns()) {
    const double value = column.value(row);
    if (std::isfinite(value)) {
      last_[column.name] = {column.name, value, row.time_s};
    } else if (const auto known = last_.find(column.name); known != last_.end()) {
      missing.push_back(known->second);
    }
  }
  return missing;
}

}  // namespace fogbench::daemon
