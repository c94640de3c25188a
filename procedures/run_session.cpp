#include "procedures/run_session.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "drivers/safe_state.hpp"
#include "procedures/check_limits.hpp"
#include "procedures/planned_points.hpp"
#include "procedures/sentence.hpp"
#include "procedures/settle_detector.hpp"
#include "procedures/transients.hpp"

namespace fogbench::procedures {
namespace {

/// A temperature that near to its target is held there: a ramp goes on from the target, so that it
/// takes as long as its rate says.
constexpr Celsius kHeld{2.0};
/// Farther behind at its end, a ramp was none.
constexpr Celsius kFarBehind{3.0};
/// By so much a ramp moves its target at a time: the resolution of the usual controllers, whose
/// memory outlives only so many writes.
constexpr Celsius kRampStep{0.1};

using config::Ampere;
using drivers::from_seconds;

/// Each correction leaves the coils' misalignment and scale error of the last residual, about 1 %:
/// three are usual, ten mean that something else moves the field.
constexpr int kCorrections = 10;
/// Readings averaged for one correction, a second apart.
constexpr std::size_t kFieldReadings = 3;
/// From a current change to a field reading that belongs to it: eddy currents, the
/// magnetometer's own filter.
constexpr std::chrono::milliseconds kFieldSettle{500};
/// A turntable that misses by more has not turned.
constexpr Degree kAzimuthTolerance{0.5};

}  // namespace

Status RunSession::start() {
  auto started = watch_.start();
  if (started) started = read_azimuth();
  if (!started) return started;
  starting_ = true;
  do {
    started = tick(watch_.now() + BenchWatch::kPeriod);
  } while (started && (watch_.new_row() == nullptr || interlocks_.undecided()));
  starting_ = false;
  const auto violated = interlocks_.tripped();
  if (!started || violated.empty()) return started;
  return Error{ErrorCode::kLimit, fmt::format("refused to start: {}", fmt::join(violated, "; "))};
}

Status RunSession::tick(drivers::Clock::Instant deadline) {
  const auto ticked = watch_.tick(deadline);
  if (!ticked) return ticked;
  const auto checked = check_interlocks();
  if (!checked) return checked;
  return after_tick_();
}

Status RunSession::check_interlocks() {
  if (watch_.new_row() == nullptr) return {};
  Status outcome;
  for (const InterlockChange& change : interlocks_.observe(watch_.observed(commanded()))) {
    const auto acted = act_on(change);
    if (!acted && (outcome || acted.error().code == ErrorCode::kStore)) outcome = acted;
  }
  return outcome;
}

Status RunSession::act_on(const InterlockChange& change) {
  using config::InterlockAction;
  const bool aborts = change.tripped && change.action == InterlockAction::kAbort;
  const auto noted = watch_.event(aborts ? "error" : (change.tripped ? "warning" : "info"),
                                  change.message, change.data_json);
  if (!noted || !change.tripped || starting_) return noted;
  if (aborts) return Error{ErrorCode::kLimit, change.message};
  if (change.action == InterlockAction::kWarn) return {};
  if (!operator_.can_resume()) {
    return Error{ErrorCode::kLimit,
                 change.message + "; the run is to pause, and nobody can resume it"};
  }
  pause_wanted_ = change.message;
  return {};
}

std::string RunSession::holds_pause() const {
  return fmt::format("{}", fmt::join(interlocks_.tripped(config::InterlockAction::kPause), "; "));
}

Status RunSession::tick_until(drivers::Clock::Instant deadline) {
  while (watch_.now() < deadline) {
    const auto ticked = tick(deadline);
    if (!ticked) return ticked;
  }
  return {};
}

Result<StepResult> RunSession::run(const PlannedStep& step) {
  step_ = &step;
  return std::visit([this](const auto& action) { return act(action); }, step.action);
}

Result<StepResult> RunSession::act(const SetTemperature& step) {
  drivers::Thermostat& thermostat = *bench_.thermostat;
  heating_ = step;
  // The target first: a mode that heats must never act on an old target.
  if (step.mode != HeatingMode::kOff) {
    const auto set = thermostat.set_target(step.target);
    if (!set) return set.error();
  }
  const auto switched = thermostat.set_mode(step.mode);
  if (!switched) return switched.error();
  return StepResult{};
}

Result<StepResult> RunSession::act(const SettleTemperature& step) {
  SettleDetector detector({step.band.value, step.dwell.count(), step.slope_c_per_h});
  TransientRecorder transients(config_, *bench_.gyro, watch_, step.segment, step.window,
                               [this](const Point& p) { return record(p); });
  const auto deadline = watch_.now() + from_seconds(step.timeout.count());
  while (!detector.settled()) {
    if (watch_.now() >= deadline) {
      const auto noted = watch_.event(
          "error", "temperature has not settled: " + detector.describe(), detector.evidence_json());
      if (!noted) return noted.error();
      return Error{ErrorCode::kTimeout,
                   fmt::format("the temperature did not settle within {}: {}",
                               duration_text(step.timeout), detector.describe())};
    }
    const auto ticked = tick(deadline);
    if (!ticked) return ticked.error();
    const auto recorded = transients.take();
    if (!recorded) return recorded.error();
    const MonitorRow* row = watch_.new_row();
    if (row == nullptr || std::isnan(row->thermostat.working_1.value)) continue;
    const drivers::ThermostatReading& t = row->thermostat;
    // The thermostat holds a target; else the room is where it settles.
    const bool heated = heating_ && heating_->mode != HeatingMode::kOff;
    detector.add(watch_.time_s(t.taken_at), working_temperature_c(t),
                 heated ? t.target.value : t.ambient.value);
  }
  const auto recorded = transients.finish();
  if (!recorded) return recorded.error();
  return StepResult{detector.evidence_json(), {}};
}

Status RunSession::record_until(drivers::Clock::Instant deadline, const std::string& segment,
                                Seconds window, const std::function<Status()>& each) {
  TransientRecorder transients(config_, *bench_.gyro, watch_, segment, window,
                               [this](const Point& p) { return record(p); });
  const Seconds wait{drivers::to_seconds(deadline - watch_.now())};
  const std::size_t due = segment.empty() ? 0 : windows_in(wait, window);
  // The first average begins with the first reading, so that the last one ends a moment after the
  // wait. One that a gap has put off is not waited for.
  const auto goes_on = [&] {
    return watch_.now() < deadline || (transients.complete() < due &&
                                       transients.next_end() < deadline + 2 * BenchWatch::kPeriod);
  };
  while (goes_on()) {
    const auto now = watch_.now();
    auto done = tick(now < deadline ? deadline : now + std::chrono::milliseconds{20});
    if (done) done = each();
    if (done) done = transients.take();
    if (!done) return done;
  }
  return transients.finish();
}

Result<StepResult> RunSession::act(const Wait& step) {
  const auto deadline = std::max(watch_.now() + from_seconds(step.duration.count()),
                                 watch_.power_on() + from_seconds(step.operating_time.count()));
  const Status waited = record_until(deadline, step.segment, step.window, [] { return Status{}; });
  if (!waited) return waited.error();
  return StepResult{};
}

Result<Celsius> RunSession::ramp_start() {
  const auto reading = bench_.thermostat->read();
  if (!reading) return reading.error();
  const Celsius temperature{working_temperature_c(*reading)};
  const bool held = heating_ && heating_->mode != HeatingMode::kOff &&
                    std::abs((heating_->target - temperature).value) <= kHeld.value;
  return held ? heating_->target : temperature;
}

Result<StepResult> RunSession::act(const Ramp& step) {
  const auto start = ramp_start();
  if (!start) return start.error();
  const double way_c = (step.to - *start).value;
  const double duration_s = std::abs(way_c) / step.rate.value * config::kSecondsPerHour;
  const auto started = act(SetTemperature{*start, way_c > 0.0 ? step.mode : HeatingMode::kNormal});
  if (!started) return started;
  const auto began = watch_.now();
  double behind_c = 0.0, most_behind_c = 0.0;
  double temperature_c = start->value;
  const auto follow = [&]() -> Status {
    const double elapsed_s = drivers::to_seconds(watch_.now() - began);
    const Celsius target =
        elapsed_s >= duration_s ? step.to : *start + Celsius{way_c * elapsed_s / duration_s};
    if (const MonitorRow* row = watch_.new_row();
        row != nullptr && !std::isnan(row->thermostat.working_1.value)) {
      temperature_c = working_temperature_c(row->thermostat);
      behind_c = std::copysign(1.0, way_c) * (target.value - temperature_c);
      most_behind_c = std::max(most_behind_c, behind_c);
    }
    const double moved_c = std::abs((target - heating_->target).value);
    if (moved_c < kRampStep.value && (target != step.to || moved_c == 0.0)) return {};
    heating_->target = target;
    return bench_.thermostat->set_target(target);
  };
  const Status waited =
      record_until(began + from_seconds(duration_s), step.segment, step.window, follow);
  if (!waited) return waited.error();
  const auto held = act(SetTemperature{step.to, HeatingMode::kNormal});
  if (!held) return held;
  const nlohmann::ordered_json evidence{
      {"from_c", start->value},         {"to_c", step.to.value}, {"rate_c_per_h", step.rate.value},
      {"temperature_c", temperature_c}, {"behind_c", behind_c},  {"most_behind_c", most_behind_c}};
  if (behind_c > kFarBehind.value) {
    const auto noted = watch_.event(
        "warning",
        fmt::format("the ramp to {} degC has ended, the temperature is {:.1f} degC behind",
                    step.to.value, behind_c),
        evidence.dump());
    if (!noted) return noted.error();
  }
  return StepResult{evidence.dump(), {}};
}

Result<StepResult> RunSession::act(const Average& step) {
  PointLabels labels;
  labels.kind = step.baseline ? PointKind::kBaseline : PointKind::kAverage;
  labels.segment = step.segment;
  return measure(step.duration, labels);
}

Result<StepResult> RunSession::act(const Prompt& step) {
  const Status asked = ask(step.text);
  if (!asked) return asked.error();
  return StepResult{};
}

Status RunSession::ask(const std::string& text) {
  const auto confirmed = operator_.confirm(text);
  if (!confirmed) return confirmed.error();
  if (*confirmed) return {};
  return Error{ErrorCode::kAborted, "the operator declined: " + text};
}

Result<StepResult> RunSession::measure(Seconds duration, const PointLabels& labels) {
  std::string reason;
  for (int attempt = 1; attempt <= kTries; ++attempt) {
    // Whatever has arrived by now was measured before the window.
    auto ticked = tick(watch_.now());
    if (!ticked) return ticked.error();
    MeasurementWindow window(config_, *bench_.gyro, watch_, watch_.next_frame(), duration);
    while (!window.complete()) {
      // The last frame may come a little after it was measured.
      ticked = tick(std::max(window.end_time(), watch_.now() + std::chrono::milliseconds{20}));
      if (!ticked) return ticked.error();
      window.add(watch_.frames());
      if (watch_.new_row() != nullptr) window.add(*watch_.new_row());
    }
    reason = window.void_reason();
    if (reason.empty()) {
      const auto recorded = record(window.point(labels));
      if (!recorded) return recorded.error();
      return StepResult{};
    }
    const auto noted = watch_.event(
        "warning", fmt::format("point voided: {}; try {} of {}", reason, attempt, kTries),
        nlohmann::json{{"segment", labels.segment}, {"reason", reason}, {"try", attempt}}.dump());
    if (!noted) return noted.error();
  }
  return StepResult{{}, reason};
}

Status RunSession::record(Point point) {
  point.test = step_->test;
  point.block = step_->block;
  return on_point_(point);
}

Result<StepResult> RunSession::act(const CompensateField& step) {
  const auto energised = energise();
  if (!energised) return energised.error();
  const std::array<const config::CoilConfig*, 2> coils{&config_.coil_horizontal,
                                                       &config_.coil_vertical};
  std::array<Ampere, 2> current = zero_.value_or(std::array<Ampere, 2>{});
  zero_.reset();
  std::array<double, 3> field_ut{};
  for (int correction = 0; correction <= kCorrections; ++correction) {
    const auto set = set_currents(current[0], current[1]);
    if (!set) return set.error();
    const auto measured = measure_field();
    if (!measured) return measured.error();
    field_ut = *measured;
    const auto along_ut = along_coils_ut(field_ut, azimuth_);
    if (std::abs(along_ut[0]) <= step.tolerance.value &&
        std::abs(along_ut[1]) <= step.tolerance.value) {
      zero_ = current;
      const nlohmann::ordered_json evidence{{"tolerance_ut", step.tolerance.value},
                                            {"corrections", correction},
                                            {"current_horizontal_a", current[0].value},
                                            {"current_vertical_a", current[1].value},
                                            {"azimuth_deg", azimuth_.value},
                                            {"residual_field_ut", field_ut}};
      return StepResult{evidence.dump(), {}};
    }
    for (std::size_t pair = 0; pair < 2; ++pair) {
      const double per_a = coils[pair]->field_ut_per_a;
      current[pair] = current[pair] - Ampere{along_ut[pair] / per_a};
      const double nulled_ut = std::abs(current[pair].value) * per_a;
      if (nulled_ut > config_.limits.compensation_maximum.value) {
        return Error{ErrorCode::kLimit,
                     fmt::format("nulling the ambient field along {} takes {:.1f} uT, the bench "
                                 "allows {} uT",
                                 pair == 0 ? "the vertical" : "north", nulled_ut,
                                 config_.limits.compensation_maximum.value)};
      }
    }
  }
  return Error{
      ErrorCode::kTimeout,
      fmt::format("the field does not come within {} uT of zero: ({:.2f}, {:.2f}, {:.2f}) "
                  "uT after {} corrections",
                  step.tolerance.value, field_ut[0], field_ut[1], field_ut[2], kCorrections)};
}

Result<StepResult> RunSession::act(const SweepLevel& step) {
  const double needed = step.axis == Axis::kZ ? 90.0 : 0.0;
  if ((step.axis == Axis::kY || step.axis == Axis::kZ) &&
      config::angle_between(azimuth_, Degree{needed}) > kAzimuthTolerance) {
    return Error{ErrorCode::kDevice,
                 fmt::format("turntable: the gyro stands at azimuth {:.2f} deg, the sweep needs {}",
                             azimuth_.value, needed)};
  }
  if (!zero_) {
    return Error{ErrorCode::kBadInput, "a sweep without a compensated zero at this azimuth"};
  }
  const auto energised = energise();
  if (!energised) return energised.error();
  auto [horizontal, vertical] = *zero_;
  const bool up = step.axis == Axis::kX;
  const Microtesla field_up = up ? step.level : step.other_pair;
  const Microtesla field_north = up ? step.other_pair : step.level;
  horizontal = horizontal + Ampere{field_up.value / config_.coil_horizontal.field_ut_per_a};
  vertical = vertical + Ampere{field_north.value / config_.coil_vertical.field_ut_per_a};
  const auto set = set_currents(horizontal, vertical);
  if (!set) return set.error();
  const auto settled = tick_until(watch_.now() + from_seconds(step.settle.count()));
  if (!settled) return settled.error();
  return measure(step.duration, {PointKind::kAverage, step.segment, step.level.value, step.axis});
}

Result<StepResult> RunSession::act(const Rotate& step) {
  // Nobody turns the gyro in a field, and the zero belongs to the azimuth that is left.
  zero_.reset();
  if (energised_) {
    const auto off = set_currents(Ampere{0.0}, Ampere{0.0});
    if (!off) return off.error();
  }
  const auto turned = bench_.turntable->rotate_to(step.azimuth);
  if (!turned) return turned.error();
  const auto read = read_azimuth();
  if (!read) return read.error();
  if (config::angle_between(azimuth_, step.azimuth) > kAzimuthTolerance) {
    return Error{ErrorCode::kDevice,
                 fmt::format("turntable: stands at {:.2f} deg after turning to {} deg",
                             azimuth_.value, step.azimuth.value)};
  }
  return StepResult{nlohmann::json{{"azimuth_deg", azimuth_.value}}.dump(), {}};
}

Status RunSession::read_azimuth() {
  auto azimuth = bench_.turntable->azimuth();
  for (int i = 1; i < kTries && !azimuth; ++i) azimuth = bench_.turntable->azimuth();
  if (!azimuth) return azimuth.error();
  azimuth_ = *azimuth;
  watch_.set_azimuth(azimuth_);
  return {};
}

Commanded RunSession::commanded() const {
  const MonitorRow* row = watch_.new_row();
  Commanded now;
  if (heating_ && heating_->mode != HeatingMode::kOff) now.target = heating_->target;
  now.horizontal = horizontal_;
  now.vertical = vertical_;
  // Before the ambient field is nulled nobody knows what a current adds up to.
  if (row != nullptr && energised_ && zero_ &&
      row->field.taken_at >= currents_since_ + kFieldSettle) {
    now.field_ut = {(horizontal_ - (*zero_)[0]).value * config_.coil_horizontal.field_ut_per_a,
                    (vertical_ - (*zero_)[1]).value * config_.coil_vertical.field_ut_per_a};
  }
  return now;
}

Status RunSession::energise() {
  if (energised_) return {};
  const auto horizontal = bench_.coil_horizontal->enable();
  if (!horizontal) return horizontal;
  const auto vertical = bench_.coil_vertical->enable();
  if (!vertical) return vertical;
  energised_ = true;
  watch_.guard_field(true);
  horizontal_ = vertical_ = Ampere{0.0};
  currents_since_ = watch_.now();
  return {};
}

Status RunSession::set_currents(Ampere horizontal, Ampere vertical) {
  const auto set = [](const config::CoilConfig& config, drivers::CoilSupply& supply, Ampere wanted,
                      Ampere& present, const char* name) -> Status {
    if (wanted == present) return {};
    const Ampere limit = current_limit(config);
    if (std::abs(wanted.value) > limit.value) {
      return Error{ErrorCode::kLimit,
                   fmt::format("{}: {:.3f} A asked for, at most {:.3f} A allowed", name,
                               wanted.value, limit.value)};
    }
    const auto done = supply.set_current(wanted);
    if (done) present = wanted;
    return done;
  };
  auto done = set(config_.coil_horizontal, *bench_.coil_horizontal, horizontal, horizontal_,
                  "coil_horizontal");
  if (done) {
    done = set(config_.coil_vertical, *bench_.coil_vertical, vertical, vertical_, "coil_vertical");
  }
  currents_since_ = watch_.now();
  return done;
}

Status RunSession::switch_off() {
  if (!switched_off_ && energised_) switched_off_ = {horizontal_, vertical_};
  energised_ = false;
  horizontal_ = vertical_ = Ampere{};
  watch_.guard_field(false);
  if (const Status off = drivers::coils_off(bench_).status(); !off) return off;
  const auto azimuth = bench_.turntable->azimuth();
  return azimuth ? Status{} : azimuth.error();
}

Status RunSession::restore(bool currents) {
  if (heating_) {
    const auto reading = bench_.thermostat->read();
    if (!reading) return reading.error();
    if (reading->mode != heating_->mode) {
      const auto heated = act(*heating_);
      if (!heated) return heated.error();
      const auto noted =
          watch_.event("warning", "thermostat: had lost its heating mode, set again");
      if (!noted) return noted;
    }
  }
  if (currents && switched_off_) {
    const auto energised = energise();
    if (!energised) return energised;
    const auto set = set_currents((*switched_off_)[0], (*switched_off_)[1]);
    if (!set) return set;
  }
  switched_off_.reset();
  return {};
}

Result<std::array<double, 3>> RunSession::measure_field() {
  const auto from = watch_.now() + kFieldSettle;
  std::array<Mean, 3> mean;
  while (mean[0].count() < kFieldReadings) {
    const auto ticked = tick(watch_.now() + BenchWatch::kPeriod);
    if (!ticked) return ticked.error();
    const MonitorRow* row = watch_.new_row();
    if (row == nullptr || row->field.taken_at < from) continue;
    for (std::size_t i = 0; i < 3; ++i) mean[i].add(row->field.field[i].value);
  }
  return std::array<double, 3>{mean[0].value(), mean[1].value(), mean[2].value()};
}

}  // namespace fogbench::procedures
