#include "procedures/interlock_gauge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "config/roles.hpp"
#include "procedures/channel_values.hpp"
#include "procedures/measurement_window.hpp"

namespace fogbench::procedures {
namespace {

using config::InterlockKind;

/// The worst, with its name; missing when one of them is.
GaugeReading worst_of(std::initializer_list<GaugeReading> readings) {
  GaugeReading worst;
  for (const GaugeReading& reading : readings) {
    if (std::isnan(reading.value)) return {};
    if (std::isnan(worst.value) || reading.value > worst.value) worst = reading;
  }
  return worst;
}

GaugeReading hottest(const drivers::ThermostatReading& t) {
  return worst_of({{t.working_1.value, "working_1"},
                   {t.working_2.value, "working_2"},
                   {t.control.value, "control"}});
}

GaugeReading disagreement(const drivers::ThermostatReading& t) {
  return worst_of({{std::abs((t.working_1 - t.control).value), "working_1"},
                   {std::abs((t.working_2 - t.control).value), "working_2"}});
}

GaugeReading field_off(const Observation& seen) {
  if (!seen.commanded.field_ut) return {};
  const auto& field = seen.row.field.field;
  const auto along_ut = along_coils_ut({field[0].value, field[1].value, field[2].value},
                                       config::Degree{seen.row.azimuth_deg});
  return worst_of({{std::abs(along_ut[0] - (*seen.commanded.field_ut)[0]), "up"},
                   {std::abs(along_ut[1] - (*seen.commanded.field_ut)[1]), "north"}});
}

GaugeReading current_off(const Observation& seen) {
  return worst_of(
      {{std::abs(seen.row.current_horizontal_a - seen.commanded.horizontal.value),
        "coil_horizontal"},
       {std::abs(seen.row.current_vertical_a - seen.commanded.vertical.value), "coil_vertical"}});
}

}  // namespace

std::vector<CalibrationDue> calibrations_of(const config::BenchConfig& bench) {
  std::vector<CalibrationDue> dates;
  const auto add = [&dates](const std::string& name, const config::InstrumentConfig& instrument) {
    const auto day = config::date_of(instrument.calibration_due);
    if (day) dates.push_back({name, *day});
  };
  config::for_each_role(add, bench);
  for (const config::AuxiliaryConfig& sensor : bench.auxiliary) add(sensor.name, sensor);
  return dates;
}

std::array<double, 2> along_coils_ut(const std::array<double, 3>& field_ut,
                                     config::Degree azimuth) {
  const double a = azimuth.value * std::numbers::pi / 180.0;
  return {field_ut[0], field_ut[1] * std::cos(a) + field_ut[2] * std::sin(a)};
}

GaugeReading InterlockGauge::measure(const Observation& seen) {
  switch (condition_.kind) {
    case InterlockKind::kOverTemperature:
      return hottest(seen.row.thermostat);
    case InterlockKind::kSensorDisagreement:
      return disagreement(seen.row.thermostat);
    case InterlockKind::kHeaterWithoutEffect:
      return stalled_heating(seen);
    case InterlockKind::kFieldMismatch:
      return field_off(seen);
    case InterlockKind::kCurrentMismatch:
      return current_off(seen);
    case InterlockKind::kGyroSilent:
      return {seen.gyro_silent_s, "gyro"};
    case InterlockKind::kGyroInvalid:
      return invalid_frames(seen.stream);
    case InterlockKind::kCalibrationOverdue:
      return overdue(seen.today);
    case InterlockKind::kChannelAbove:
    case InterlockKind::kChannelBelow:
      return channel(seen.row);
  }
  return {};
}

GaugeReading InterlockGauge::stalled_heating(const Observation& seen) {
  const auto& target = seen.commanded.target;
  const double carrier_c = working_temperature_c(seen.row.thermostat);
  // A moment without a reading neither proves an effect nor its lack.
  if (target && std::isnan(carrier_c)) return {};
  const double now_s = seen.row.time_s;
  const bool asked = target && target->value - carrier_c > condition_.near_target.value;
  if (!asked) {
    last_effect_.reset();
    return {0.0, "thermostat"};
  }
  if (!last_effect_ || carrier_c >= last_effect_->temperature_c + condition_.rise.value) {
    last_effect_ = Effect{now_s, carrier_c};
  }
  return {now_s - last_effect_->time_s,
          fmt::format("thermostat at {:.2f} degC with a target of {:.2f} degC", carrier_c,
                      target->value)};
}

GaugeReading InterlockGauge::invalid_frames(const drivers::StreamStatistics& stream) {
  const drivers::StreamStatistics before = last_stream_.value_or(stream);
  last_stream_ = stream;
  const auto invalid = static_cast<double>(stream.frames_invalid - before.frames_invalid);
  const auto good = static_cast<double>(stream.frames_good - before.frames_good);
  // Silence says nothing of validity: it has an interlock of its own.
  if (invalid + good == 0.0) return {};
  return {100.0 * invalid / (invalid + good), "gyro"};
}

GaugeReading InterlockGauge::channel(const MonitorRow& row) const {
  GaugeReading reading{std::numeric_limits<double>::quiet_NaN(), condition_.channel};
  for_each_value(row, [&](std::string_view name, double value) {
    if (name == condition_.channel) reading.value = value;
  });
  return reading;
}

GaugeReading InterlockGauge::overdue(std::chrono::sys_days today) const {
  GaugeReading worst;
  for (const CalibrationDue& due : calibrations_) {
    const auto days = static_cast<double>((today - due.day).count());
    if (std::isnan(worst.value) || days > worst.value) worst = {days, due.instrument};
  }
  return worst;
}

}  // namespace fogbench::procedures
