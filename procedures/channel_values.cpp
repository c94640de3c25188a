#include "procedures/channel_values.hpp"

#include <limits>
#include <set>

#include "config/channels.hpp"

namespace fogbench::procedures {
namespace {

constexpr PointChannel of_point(std::string_view name, double Point::*value) {
  const config::Channel* const channel = config::find_channel(name);
  return {channel->name, channel->meaning, value};
}

constexpr MonitorChannel of_row(std::string_view name, double (*value)(const MonitorRow&)) {
  const config::Channel* const channel = config::find_channel(name);
  return {channel->name, channel->meaning, value};
}

constexpr PointChannel kOfPoint[] = {
    of_point("time_s", &Point::time_s),
    of_point("duration_s", &Point::duration_s),
    of_point("rate_deg_per_h", &Point::rate_deg_per_h),
    of_point("rate_std_deg_per_h", &Point::rate_std_deg_per_h),
    of_point("rate_std_error_deg_per_h", &Point::rate_std_error_deg_per_h),
    of_point("temperature_c", &Point::temperature_c),
    of_point("temperature_start_c", &Point::temperature_start_c),
    of_point("temperature_end_c", &Point::temperature_end_c),
    of_point("temperature_rate_c_per_h", &Point::temperature_rate_c_per_h),
    of_point("temperature_gradient_c", &Point::temperature_gradient_c),
    of_point("temperature_control_c", &Point::temperature_control_c),
    of_point("target_c", &Point::target_c),
    of_point("ambient_c", &Point::ambient_c),
    of_point("heater_w", &Point::heater_w),
    of_point("field_x_ut", &Point::field_x_ut),
    of_point("field_y_ut", &Point::field_y_ut),
    of_point("field_z_ut", &Point::field_z_ut),
    of_point("field_set_ut", &Point::field_set_ut),
    of_point("coil_current_a", &Point::coil_current_a),
    of_point("current_horizontal_a", &Point::current_horizontal_a),
    of_point("current_vertical_a", &Point::current_vertical_a),
    of_point("azimuth_deg", &Point::azimuth_deg),
};

constexpr MonitorChannel kOfRow[] = {
    of_row("time_s", [](const MonitorRow& row) { return row.time_s; }),
    of_row("temperature_working_1_c",
           [](const MonitorRow& row) { return row.thermostat.working_1.value; }),
    of_row("temperature_working_2_c",
           [](const MonitorRow& row) { return row.thermostat.working_2.value; }),
    of_row("temperature_control_c",
           [](const MonitorRow& row) { return row.thermostat.control.value; }),
    of_row("ambient_c", [](const MonitorRow& row) { return row.thermostat.ambient.value; }),
    of_row("target_c", [](const MonitorRow& row) { return row.thermostat.target.value; }),
    of_row("boost_w", [](const MonitorRow& row) { return row.thermostat.boost_power.value; }),
    of_row("normal_w", [](const MonitorRow& row) { return row.thermostat.normal_power.value; }),
    of_row("field_x_ut", [](const MonitorRow& row) { return row.field.field[0].value; }),
    of_row("field_y_ut", [](const MonitorRow& row) { return row.field.field[1].value; }),
    of_row("field_z_ut", [](const MonitorRow& row) { return row.field.field[2].value; }),
    of_row("current_horizontal_a", [](const MonitorRow& row) { return row.current_horizontal_a; }),
    of_row("current_vertical_a", [](const MonitorRow& row) { return row.current_vertical_a; }),
    of_row("azimuth_deg", [](const MonitorRow& row) { return row.azimuth_deg; }),
};

}  // namespace

std::span<const PointChannel> point_channels() {
  return kOfPoint;
}

std::span<const MonitorChannel> monitor_channels() {
  return kOfRow;
}

void for_each_value(const MonitorRow& row,
                    const std::function<void(std::string_view name, double value)>& use) {
  for (const MonitorChannel& channel : kOfRow) use(channel.name, channel.value(row));
  for (const auto& [name, value] : row.auxiliary) use(name, value);
}

double value_of(const AuxiliaryValues& values, std::string_view name) {
  const auto found = values.find(name);
  return found == values.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
}

std::vector<std::string> auxiliary_names(std::span<const Point> points) {
  std::set<std::string> names;
  for (const Point& point : points) {
    for (const auto& [name, value] : point.auxiliary) names.insert(name);
  }
  return {names.begin(), names.end()};
}

}  // namespace fogbench::procedures
