#include "procedures/bench_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/frame_rate_meter.hpp"
#include "drivers/named_error.hpp"

namespace fogbench::procedures {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

drivers::ThermostatReading missing_thermostat() {
  drivers::ThermostatReading r;
  r.working_1 = r.working_2 = r.control = r.ambient = r.target = config::Celsius{kMissing};
  r.boost_power = r.normal_power = config::Watt{kMissing};
  return r;
}

drivers::FieldReading missing_field() {
  drivers::FieldReading r;
  r.field.fill(config::Microtesla{kMissing});
  return r;
}

}  // namespace

Status BenchWatch::start() {
  const Instant begun = clock_.now();
  power_on_ = begun;
  next_reading_ = begun;
  const auto patience =
      drivers::from_seconds(std::max(kLongestOutage.count(), 3.0 / bench_.gyro->frame_rate_hz()));
  frames_.clear();
  for (;;) {
    const auto drained = drain();
    if (!drained) return drained;
    if (!frames_.index.empty()) break;
    if (clock_.now() - begun > patience) {
      return Error{ErrorCode::kTimeout,
                   fmt::format("gyro: no frame within {} s", drivers::to_seconds(patience))};
    }
    clock_.sleep_for(std::chrono::milliseconds{10});
  }
  power_on_ = bench_.gyro->time_of(0);
  stream_before_ = bench_.gyro->statistics();
  stream_before_.frames_good -= frames_.index.size();  // these are this run's
  return record_frames();
}

Status BenchWatch::tick(Instant deadline) {
  frames_.clear();
  has_new_row_ = false;
  auto drained = sleep_until(std::min(deadline, next_reading_));
  if (drained) drained = drain();
  if (const auto recorded = record_frames(); !recorded) return recorded;
  if (drained) drained = check_frame_rate();
  if (!drained) return drained;
  const Instant now = clock_.now();
  if (now < next_reading_ || interrupted_()) return {};
  next_reading_ = std::max(next_reading_ + kPeriod, now);
  if (const auto noted = note_calendar(); !noted) return noted;
  return read_slow_instruments();
}

Status BenchWatch::sleep_until(Instant deadline) {
  while (clock_.now() < deadline && !interrupted_()) {
    clock_.sleep_until(std::min(deadline, clock_.now() + kNap));
    if (bench_.gyro->measured_frame_rate()) continue;
    if (const auto drained = drain(); !drained) return drained;
  }
  return {};
}

Status BenchWatch::drain() {
  const std::size_t before = frames_.index.size();
  const Status outcome = bench_.gyro->read(frames_);
  if (frames_.index.size() > before) {
    next_frame_ = frames_.index.back() + 1;
    gyro_.last_taken = clock_.now();
  }
  return note(gyro_, outcome);
}

Status BenchWatch::record_frames() {
  if (kept_from_record_ || frames_.index.empty()) return {};
  return recorder_.gyro_samples(frames_);
}

Status BenchWatch::check_frame_rate() {
  const auto rate = bench_.gyro->measured_frame_rate();
  if (!rate || rate_as_stated_ == rate->as_stated) return {};
  const bool first = !rate_as_stated_;
  rate_as_stated_ = rate->as_stated;
  if (first && rate->as_stated) return {};
  const double stated_hz = bench_.gyro->frame_rate_hz();
  const double off_percent = 100.0 * (rate->measured_hz / stated_hz - 1.0);
  const auto sends =
      fmt::format("gyro: sends {:.1f} frames a second by this machine's clock", rate->measured_hz);
  if (rate->as_stated)
    return event("info", fmt::format("{}, {} as stated again", sends, stated_hz));
  const auto message = fmt::format(
      "{}, expected {} as its description states, within {} %: times in the record would be {:.1f} "
      "% "
      "{}",
      sends, stated_hz, 100.0 * drivers::FrameRateMeter::kTolerance, std::abs(off_percent),
      off_percent > 0.0 ? "too long" : "too short");
  if (first) return Error{ErrorCode::kDevice, message};
  return event(
      "warning", message,
      fmt::format(R"({{"measured_hz":{:.3f},"stated_hz":{}}})", rate->measured_hz, stated_hz));
}

Status BenchWatch::read_slow_instruments() {
  row_.time_s = now_s();
  row_.azimuth_deg = azimuth_.value;

  const auto thermostat = bench_.thermostat->read();
  Status outcome = thermostat ? check_new(thermostat_, thermostat->taken_at) : thermostat.error();
  row_.thermostat = outcome ? *thermostat : missing_thermostat();
  if (auto noted = note(thermostat_, outcome); !noted) return noted;
  if (interrupted_()) return {};

  const auto field = bench_.magnetometer->read();
  outcome = field ? check_new(magnetometer_, field->taken_at) : field.error();
  row_.field = outcome ? *field : missing_field();
  if (auto noted = note(magnetometer_, outcome); !noted) return noted;
  if (interrupted_()) return {};

  const auto read_coil = [&](drivers::CoilSupply& coil, Outage& outage, double& current_a) {
    const auto reading = coil.read();
    const Status result = reading ? check_new(outage, reading->taken_at) : reading.error();
    current_a = result ? reading->measured.value : kMissing;
    return note(outage, result);
  };
  auto noted = read_coil(*bench_.coil_horizontal, coil_horizontal_, row_.current_horizontal_a);
  if (!noted) return noted;
  noted = read_coil(*bench_.coil_vertical, coil_vertical_, row_.current_vertical_a);
  if (!noted) return noted;

  if (auto read = read_auxiliary(); !read) return read;

  has_new_row_ = true;
  recent_.push_back(row_);
  while (recent_.front().time_s < row_.time_s - kRecentS) recent_.pop_front();
  if (kept_from_record_) return {};
  return recorder_.monitor(row_);
}

Status BenchWatch::read_auxiliary() {
  auxiliary_outages_.resize(bench_.auxiliary.size());
  for (std::size_t i = 0; i < bench_.auxiliary.size() && !interrupted_(); ++i) {
    drivers::AuxiliarySensor& sensor = *bench_.auxiliary[i];
    AuxiliaryOutage& outage = auxiliary_outages_[i];
    for (const auto& channel : sensor.channels()) row_.auxiliary[channel.name] = kMissing;
    if (clock_.now() < outage.ask_again) continue;
    const auto values = sensor.read();
    std::string fault;
    for (std::size_t c = 0; c < values.size(); ++c) {
      if (values[c]) row_.auxiliary[sensor.channels()[c].name] = *values[c];
      if (!values[c] && fault.empty()) fault = values[c].error().message;
    }
    const bool silent = std::none_of(values.begin(), values.end(),
                                     [](const auto& value) { return static_cast<bool>(value); });
    if (silent) outage.ask_again = clock_.now() + kAuxiliaryPause;
    // Told when it begins and when it ends; what it says in between may change with every word.
    if (fault.empty() == outage.says.empty()) continue;
    Status noted;
    if (fault.empty()) {
      noted = event("info", fmt::format("{}: answers again after {:.1f} s", sensor.name(),
                                        drivers::to_seconds(clock_.now() - outage.since)));
    } else {
      noted =
          event("warning", fault + "; its channels are missing until it answers, the run goes on");
      outage.since = clock_.now();
    }
    if (!noted) return noted;
    outage.says = fault;
  }
  return {};
}

Status BenchWatch::note_calendar() {
  const auto offset = clock_.calendar_offset();
  const auto step = offset - calendar_noted_;
  if (kept_from_record_ || std::chrono::abs(step) <= kCalendarStep) return {};
  const double step_s = drivers::to_seconds(step);
  const auto noted = event(
      "warning",
      fmt::format("the machine's clock was set {} by {:.1f} s{}; dates of this run follow the "
                  "clock as it was at its start",
                  step_s > 0.0 ? "forward" : "back", std::abs(step_s),
                  step_s > 0.0 ? ", or the machine slept" : ""),
      fmt::format(R"({{"clock_step_s":{:.3f}}})", step_s));
  if (noted) calendar_noted_ = offset;
  return noted;
}

Status BenchWatch::check_new(Outage& outage, Instant taken_at) {
  if (taken_at <= outage.last_taken) {
    return Error{ErrorCode::kStale, "the same reading came again"};
  }
  outage.last_taken = taken_at;
  return {};
}

Status BenchWatch::note(Outage& outage, const Status& outcome) {
  const Instant now = clock_.now();
  if (outcome) {
    if (!outage.since) return {};
    const double lasted_s = drivers::to_seconds(now - *outage.since);
    outage.since.reset();
    return event("info",
                 fmt::format("{}: answers again after {:.1f} s", outage.instrument, lasted_s));
  }
  const std::string& fault = outcome.error().message;
  const bool unplugged = outcome.error().code == ErrorCode::kUnplugged;
  if (!outage.since) {
    outage.since = now;
    const auto noted = event("warning", fmt::format("{}; its readings are missing until it answers",
                                                    drivers::named(outage.instrument, fault)));
    if (!noted) return noted;
  }
  if (unplugged && field_guarded_) return outcome;
  const config::Seconds longest = unplugged ? config_.limits.absence_maximum : kLongestOutage;
  if (now - *outage.since <= drivers::from_seconds(longest.count())) return {};
  // Nobody waits for it any longer, so this is no interruption any more.
  return Error{unplugged ? ErrorCode::kDevice : outcome.error().code,
               fmt::format("{}; no reading for {} s", drivers::named(outage.instrument, fault),
                           longest.count())};
}

bool BenchWatch::all_answer() const {
  for (const Outage* outage :
       {&gyro_, &thermostat_, &magnetometer_, &coil_horizontal_, &coil_vertical_}) {
    if (outage->since) return false;
  }
  return true;
}

Observation BenchWatch::observed(const Commanded& commanded) const {
  return {row_, commanded, bench_.gyro->statistics(),
          drivers::to_seconds(clock_.now() - gyro_.last_taken),
          std::chrono::floor<std::chrono::days>(clock_.wall_now() + clock_.calendar_offset())};
}

Status BenchWatch::event(const std::string& severity, const std::string& message,
                         const std::string& data_json) {
  if (kept_from_record_) return {};
  return recorder_.event(now_s(), severity, message, data_json);
}

}  // namespace fogbench::procedures
