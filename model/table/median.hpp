#pragma once

#include <algorithm>
#include <limits>
#include <vector>

namespace fogbench::model {

/// The middle of the values, of an even number the upper of the two; NaN for none. Precondition: no
/// NaN among them.
inline double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace fogbench::model
