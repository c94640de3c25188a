#include "procedures/check_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "procedures/reach.hpp"
#include "procedures/sentence.hpp"

namespace fogbench::procedures {
namespace {

const config::CoilConfig& coil_of(Axis axis, const config::BenchConfig& bench) {
  return axis == Axis::kX ? bench.coil_horizontal : bench.coil_vertical;
}

/// Smallest and largest value asked of one quantity.
struct Span {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
  void take(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
  bool empty() const { return most < least; }
};

/// Of the ramps one way: what is asked, and what the bench can where it can least.
struct Rates {
  double fastest_asked = 0.0;
  double least_possible = std::numeric_limits<double>::infinity();
  Celsius at{0.0};
};

/// To two significant digits, so that it still holds.
double rounded_down(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return unit >= 1.0 ? unit * std::floor(value / unit)
                     : std::floor(value / unit) / std::round(1.0 / unit);
}

class Checker {
 public:
  explicit Checker(const config::BenchConfig& bench)
      : bench_(bench),
        reach_(reach_of(bench)),
        temperature_minimum_(bench.limits.temperature_minimum.value),
        temperature_maximum_(bench.limits.temperature_maximum.value) {
    // A device file that states no range (0 to 0) leaves it to the bench.
    const config::ModbusDevice& device = bench.thermostat.device;
    if (device.target_minimum < device.target_maximum) {
      temperature_minimum_ = std::max(temperature_minimum_, device.target_minimum.value);
      temperature_maximum_ = std::min(temperature_maximum_, device.target_maximum.value);
    }
  }

  Status step(const PlannedStep& step) {
    where_ = &step.where;
    return std::visit([this](const auto& action) { return check(action); }, step.action);
  }

  std::vector<std::string> finish(Seconds total, const std::string& procedure,
                                  std::vector<Error>& problems) const {
    const Seconds limit = bench_.limits.run_time_maximum;
    if (total > limit) {
      problems.push_back(
          {ErrorCode::kLimit, fmt::format("{}: the run takes about {}, the bench's limit is {}",
                                          procedure, duration_text(total), duration_text(limit))});
    }
    std::vector<std::string> met;
    if (!temperature_.empty()) {
      met.push_back(fmt::format("temperature: targets {} to {} degC, allowed {} to {} degC",
                                temperature_.least, temperature_.most, temperature_minimum_,
                                temperature_maximum_));
      met.back() += reach_
                        ? fmt::format("; in a room of {} degC {} reach {:.1f} to {:.1f} degC of it",
                                      bench_.estimates.room.value,
                                      reach_->cools() ? "heaters and cooler" : "the heaters",
                                      std::max(reach_->lowest().value, temperature_minimum_),
                                      std::min(reach_->highest().value, temperature_maximum_))
                        : "; what heaters and room can is not known: the bench's file has no "
                          "\"thermal\"";
    }
    for (const auto& [rates, way] : {std::pair{&up_, "up"}, std::pair{&down_, "down"}}) {
      if (rates->fastest_asked == 0.0) continue;
      met.push_back(fmt::format("ramps {}: {} degC/h", way, rates->fastest_asked));
      if (reach_) {
        met.back() += fmt::format(", the bench can {:.1f} degC/h at {} degC", rates->least_possible,
                                  rates->at.value);
      }
    }
    if (up_.fastest_asked + down_.fastest_asked > 0.0 &&
        bench_.thermostat.device.sensor_lag.count() == 0.0) {
      met.push_back(
          "temperatures of the ramps: as the sensors read them, since nobody has stated their "
          "lag (sensor_lag_s of the thermostat)");
    }
    if (!field_.empty()) {
      met.push_back(fmt::format("field: levels {} to {} uT, allowed up to {} uT either way",
                                field_.least, field_.most, bench_.limits.field_maximum.value));
      met.push_back(fmt::format(
          "coil current: at most {:.2f} A with {} uT of ambient field to null, allowed {:.2f} A",
          current_, bench_.limits.compensation_maximum.value, current_limit_));
    }
    met.push_back(
        fmt::format("run time: about {}, allowed {}", duration_text(total), duration_text(limit)));
    return met;
  }

 private:
  Error beyond(const std::string& message) const {
    return Error{ErrorCode::kLimit, *where_ + ": " + message};
  }
  Error wrong(const std::string& message) const {
    return Error{ErrorCode::kBadInput, *where_ + ": " + message};
  }

  Status check(const SetTemperature& s) {
    if (s.mode == HeatingMode::kOff) return {};
    return check_target("target_c", s.target);
  }
  Status check_target(const char* key, Celsius target) {
    if (target.value < temperature_minimum_ || target.value > temperature_maximum_) {
      return beyond(fmt::format("{} is {} degC, the bench allows {} to {} degC", key, target.value,
                                temperature_minimum_, temperature_maximum_));
    }
    if (reach_ && target < reach_->lowest()) {
      return beyond(
          reach_->cools()
              ? fmt::format("{} is {} degC, the bench's cooler comes down to {:.1f} degC in a room "
                            "of {} degC",
                            key, target.value, reach_->lowest().value, bench_.estimates.room.value)
              : fmt::format("{} is {} degC in a room of {} degC (room_c of the bench), and the "
                            "bench has nothing that cools",
                            key, target.value, bench_.estimates.room.value));
    }
    if (reach_ && target > reach_->highest()) {
      return beyond(
          fmt::format("{} is {} degC, the bench's normal heater holds {:.1f} degC at most "
                      "in a room of {} degC",
                      key, target.value, reach_->highest().value, bench_.estimates.room.value));
    }
    temperature_.take(target.value);
    return {};
  }
  Status check(const Ramp& s) {
    if (const Status ok = check_target("to_c", s.to); !ok) return ok;
    const bool up = s.to > s.from;
    Rates& rates = up ? up_ : down_;
    if (s.to == s.from) return {};
    rates.fastest_asked = std::max(rates.fastest_asked, s.rate.value);
    if (!reach_) return {};
    const CelsiusPerHour fastest =
        up ? reach_->fastest_up(s.to, s.mode) : reach_->fastest_down(s.to);
    if (fastest.value < rates.least_possible) {
      rates.least_possible = fastest.value;
      rates.at = s.to;
    }
    if (s.rate <= fastest) return {};
    const Celsius end = up ? reach_->end_up(s.rate, s.mode) : reach_->end_down(s.rate);
    const bool begins = up ? end > s.from : end < s.from;
    const std::string nearest =
        fastest.value >= 0.1 ? fmt::format("the nearest rate that goes all the way is {} degC/h",
                                           rounded_down(fastest.value))
                             : std::string("no rate goes all the way: it comes to rest before");
    return beyond(fmt::format("a ramp from {} to {} degC at {} degC/h, {} {}; {}", s.from.value,
                              s.to.value, s.rate.value,
                              up                ? "which the heaters"
                              : reach_->cools() ? "which the cooler"
                                                : "which the room, without a cooler,",
                              begins ? fmt::format("can follow as far as {:.1f} degC", end.value)
                                     : std::string("cannot follow at all"),
                              nearest));
  }
  Status check(const SweepLevel& s) {
    const auto across = check_current(s.axis == Axis::kX ? Axis::kNorth : Axis::kX, s.other_pair);
    if (!across) return across;
    const auto along = check_current(s.axis, s.level);
    if (!along) return along;
    field_.take(s.level.value);
    return check_zero(s.axis);
  }
  Status check_current(Axis axis, Microtesla field) {
    const double level = field.value;
    if (std::abs(level) > bench_.limits.field_maximum.value) {
      return beyond(fmt::format("a level of {} uT, the bench allows {} uT either way", level,
                                bench_.limits.field_maximum.value));
    }
    const double current = worst_current(axis, field, bench_).value;
    const double limit = current_limit(coil_of(axis, bench_)).value;
    if (current > limit) {
      return beyond(fmt::format(
          "a level of {} uT and up to {} uT of ambient field need {:.2f} A, the coil and its "
          "supply allow {:.2f} A",
          level, bench_.limits.compensation_maximum.value, current, limit));
    }
    if (current > current_) {
      current_ = current;
      current_limit_ = limit;
    }
    return {};
  }
  Status check_zero(Axis axis) const {
    const double needed = axis == Axis::kZ ? 90.0 : 0.0;
    if ((axis == Axis::kY || axis == Axis::kZ) && azimuth_.value != needed) {
      return wrong(fmt::format(
          "a sweep along O{} at azimuth {} deg, where no coil drives it; rotate to {} deg first",
          axis == Axis::kY ? 'Y' : 'Z', azimuth_.value, needed));
    }
    if (!compensated_) {
      return wrong(
          "a sweep without compensate_field since the start or the last rotation: the "
          "ambient field turns relative to the gyro");
    }
    return {};
  }
  Status check(const CompensateField&) {
    compensated_ = true;
    return {};
  }
  Status check(const Rotate& s) {
    azimuth_ = s.azimuth;
    compensated_ = false;
    return {};
  }
  template <class NothingToCheck>
  Status check(const NothingToCheck&) {
    return {};
  }

  const config::BenchConfig& bench_;
  std::optional<Reach> reach_;
  double temperature_minimum_, temperature_maximum_;
  Span temperature_, field_;
  Rates up_, down_;
  double current_ = 0.0, current_limit_ = 0.0;
  Degree azimuth_{0.0};
  bool compensated_ = false;
  const std::string* where_ = nullptr;
};

}  // namespace

config::Ampere worst_current(Axis axis, Microtesla level, const config::BenchConfig& bench) {
  const double field = std::abs(level.value) + bench.limits.compensation_maximum.value;
  return config::Ampere{field / coil_of(axis, bench).field_ut_per_a};
}

config::Ampere current_limit(const config::CoilConfig& coil) {
  config::Ampere limit = coil.current_limit;
  // A supply that states no range (0 to 0) leaves it to the coil.
  if (coil.device.minimum < coil.device.maximum) {
    limit = std::min(limit, config::Ampere{std::min(coil.device.maximum, -coil.device.minimum)});
  }
  return limit;
}

std::vector<std::string> check_limits(const std::string& procedure,
                                      const std::vector<PlannedStep>& steps,
                                      const config::BenchConfig& bench,
                                      std::vector<Error>& problems) {
  Checker checker(bench);
  Seconds total{0.0};
  for (const PlannedStep& step : steps) {
    const auto status = checker.step(step);
    // In a loop the same may be wrong at every turn.
    const bool said = !status && std::any_of(problems.begin(), problems.end(), [&](const Error& e) {
      return e.message == status.error().message;
    });
    if (!status && !said) problems.push_back(status.error());
    total += step.estimate;
  }
  return checker.finish(total, procedure, problems);
}

}  // namespace fogbench::procedures
