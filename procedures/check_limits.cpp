#include "procedures/check_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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

class Checker {
 public:
  explicit Checker(const config::BenchConfig& bench)
      : bench_(bench),
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

  Result<std::vector<std::string>> finish(Seconds total, const std::string& procedure) const {
    const Seconds limit = bench_.limits.run_time_maximum;
    if (total > limit) {
      return Error{ErrorCode::kLimit,
                   fmt::format("{}: the run takes about {}, the bench's limit is {}", procedure,
                               duration_text(total), duration_text(limit))};
    }
    std::vector<std::string> met;
    if (!temperature_.empty()) {
      met.push_back(fmt::format("temperature: targets {} to {} degC, allowed {} to {} degC",
                                temperature_.least, temperature_.most, temperature_minimum_,
                                temperature_maximum_));
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
    const double target = s.target.value;
    if (target < temperature_minimum_ || target > temperature_maximum_) {
      return beyond(fmt::format("target_c is {} degC, the bench allows {} to {} degC", target,
                                temperature_minimum_, temperature_maximum_));
    }
    temperature_.take(target);
    return {};
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
  double temperature_minimum_, temperature_maximum_;
  Span temperature_, field_;
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

Result<std::vector<std::string>> check_limits(const std::string& procedure,
                                              const std::vector<PlannedStep>& steps,
                                              const config::BenchConfig& bench) {
  Checker checker(bench);
  Seconds total{0.0};
  for (const PlannedStep& step : steps) {
    const auto status = checker.step(step);
    if (!status) return status.error();
    total += step.estimate;
  }
  return checker.finish(total, procedure);
}

}  // namespace fogbench::procedures
