#include "procedures/measurement_window.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fogbench::procedures {
namespace {

std::int64_t frames_in(config::Seconds duration, const drivers::Gyro& gyro) {
  return std::max<std::int64_t>(1, std::llround(duration.count() * gyro.frame_rate_hz()));
}

/// Slow readings come once a second; a window with fewer than half of them is blind.
bool too_few(std::size_t readings, config::Seconds duration) {
  return static_cast<double>(readings) < std::floor(duration.count()) / 2.0;
}

}  // namespace

double working_temperature_c(const drivers::ThermostatReading& reading) {
  return (reading.working_1.value + reading.working_2.value) / 2.0;
}

MeasurementWindow::MeasurementWindow(const config::BenchConfig& config, const drivers::Gyro& gyro,
                                     const BenchWatch& watch, std::int64_t begin,
                                     config::Seconds duration)
    : config_(config),
      gyro_(gyro),
      power_on_(watch.power_on()),
      duration_(duration),
      frames_(begin, frames_in(duration, gyro),
              std::llround(config.gyro.max_gap.count() * gyro.frame_rate_hz())),
      start_s_(watch.time_s(gyro.time_of(frames_.begin()))),
      end_s_(watch.time_s(end_time())),
      temperature_(start_s_, end_s_, config.thermostat.device.sensor_lag.count()),
      gradient_(temperature_),
      control_(temperature_),
      needed_(watch.needed()) {
  for (const MonitorRow& row : watch.recent_rows()) add(row);
}

drivers::Clock::Instant MeasurementWindow::last_reading_time() const {
  const double lag_s = config_.thermostat.device.sensor_lag.count();
  if (lag_s == 0.0) return end_time();
  return end_time() + drivers::from_seconds(SensorWindow::reach_s(lag_s));
}

void MeasurementWindow::add(const MonitorRow& row) {
  const auto inside = [this](drivers::Clock::Instant taken_at) {
    return taken_at >= gyro_.time_of(frames_.begin()) && taken_at <= end_time();
  };
  const drivers::ThermostatReading& t = row.thermostat;
  const double read_at_s = drivers::to_seconds(t.taken_at - power_on_);
  temperature_.add(read_at_s, working_temperature_c(t));
  gradient_.add(read_at_s, t.working_1.value - t.working_2.value);
  control_.add(read_at_s, t.control.value);
  if (inside(t.taken_at)) {
    target_.add(t.target.value);
    ambient_.add(t.ambient.value);
    heater_.add(t.boost_power.value + t.normal_power.value);
  }
  if (inside(row.field.taken_at)) {
    field_x_.add(row.field.field[0].value);
    field_y_.add(row.field.field[1].value);
    field_z_.add(row.field.field[2].value);
  }
  if (inside(power_on_ + drivers::from_seconds(row.time_s))) {
    current_horizontal_.add(row.current_horizontal_a);
    current_vertical_.add(row.current_vertical_a);
    azimuth_.add(row.azimuth_deg);
    for (const auto& [name, value] : row.auxiliary) auxiliary_[name].add(value);
  }
}

std::string MeasurementWindow::void_reason() const {
  if (frames_.has_gap()) {
    return fmt::format("{} consecutive frames of the gyro lost, at most {} s may be",
                       frames_.worst_loss(), config_.gyro.max_gap.count());
  }
  if (too_few(temperature_.count(), duration_)) {
    return fmt::format("only {} readings of the thermostat in {} s", temperature_.count(),
                       duration_.count());
  }
  if (too_few(field_x_.count(), duration_)) {
    return fmt::format("only {} readings of the magnetometer in {} s", field_x_.count(),
                       duration_.count());
  }
  for (const auto& [name, current] : {std::pair{"coil_horizontal", &current_horizontal_},
                                      std::pair{"coil_vertical", &current_vertical_}}) {
    if (too_few(current->count(), duration_)) {
      return fmt::format("only {} readings of {} in {} s", current->count(), name,
                         duration_.count());
    }
  }
  for (const std::string& name : needed_) {
    const auto found = auxiliary_.find(name);
    const std::size_t readings = found == auxiliary_.end() ? 0 : found->second.count();
    if (too_few(readings, duration_)) {
      return fmt::format("only {} readings of {} in {} s", readings, name, duration_.count());
    }
  }
  return {};
}

Point MeasurementWindow::point(const PointLabels& labels) const {
  Point p;
  p.kind = labels.kind;
  p.segment = labels.segment;
  p.time_s = (start_s_ + end_s_) / 2.0;
  p.duration_s = end_s_ - start_s_;
  p.rate_deg_per_h = frames_.mean() - config_.gyro.reference_rate.value;
  p.rate_std_deg_per_h = frames_.standard_deviation();
  p.rate_std_error_deg_per_h =
      p.rate_std_deg_per_h / std::sqrt(static_cast<double>(frames_.count()));
  p.count = frames_.count();
  p.dropped = frames_.dropped();
  p.temperature_c = temperature_.mean();
  p.temperature_start_c = temperature_.start();
  p.temperature_end_c = temperature_.end();
  p.temperature_rate_c_per_h = temperature_.rate_per_s() * 3600.0;
  p.temperature_gradient_c = gradient_.mean();
  p.temperature_control_c = control_.mean();
  p.target_c = target_.value();
  p.ambient_c = ambient_.value();
  p.heater_w = heater_.value();
  p.field_x_ut = field_x_.value();
  p.field_y_ut = field_y_.value();
  p.field_z_ut = field_z_.value();
  p.field_set_ut = labels.field_set_ut;
  const double horizontal = current_horizontal_.value();
  const double vertical = current_vertical_.value();
  const bool vertical_pair = labels.driven ? *labels.driven != config::Axis::kX
                                           : std::abs(vertical) > std::abs(horizontal);
  p.coil_current_a = vertical_pair ? vertical : horizontal;
  p.current_horizontal_a = horizontal;
  p.current_vertical_a = vertical;
  p.azimuth_deg = azimuth_.value();
  for (const auto& [name, mean] : auxiliary_) p.auxiliary[name] = mean.value();
  return p;
}

}  // namespace fogbench::procedures
