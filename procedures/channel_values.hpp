#pragma once
// How each channel of the record (config/channels.hpp) is read off a point and off a monitor row.

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "procedures/recorder.hpp"

namespace fogbench::procedures {

/// A number of a point, in the order of schema and exports.
struct PointChannel {
  std::string_view name, meaning;
  double Point::*value;
};
std::span<const PointChannel> point_channels();

struct MonitorChannel {
  std::string_view name, meaning;
  double (*value)(const MonitorRow& row);
};
std::span<const MonitorChannel> monitor_channels();

/// Every value of the row, auxiliary sensors' behind the bench's own; NaN is missing.
void for_each_value(const MonitorRow& row,
                    const std::function<void(std::string_view name, double value)>& use);

/// NaN when it is not there.
double value_of(const AuxiliaryValues& values, std::string_view name);
/// The auxiliary channels that any of the points has, by name.
std::vector<std::string> auxiliary_names(std::span<const Point> points);

}  // namespace fogbench::procedures
