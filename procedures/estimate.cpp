#include "procedures/estimate.hpp"

#include <algorithm>
#include <cmath>

namespace fogbench::procedures {
namespace {

/// Follows the bench through the plan, as far as durations depend on what came before.
class Estimator {
 public:
  explicit Estimator(const config::BenchConfig& bench)
      : bench_(bench), target_(bench.estimates.room), temperature_(bench.estimates.room) {}

  Seconds step(PlannedStep& step) {
    const Seconds duration = std::visit([this](auto& action) { return of(action); }, step.action);
    elapsed_ += duration;
    return duration;
  }

 private:
  Seconds of(const SetTemperature& s) {
    target_ = s.mode == HeatingMode::kOff ? bench_.estimates.room : s.target;
    return Seconds{0.0};
  }
  Seconds of(Ramp& s) {
    s.from = temperature_;
    target_ = temperature_ = s.to;
    return Seconds{3600.0 * std::abs(s.to.value - s.from.value) / s.rate.value};
  }
  Seconds of(const SettleTemperature& s) {
    const double distance = target_.value - temperature_.value;
    const double way = std::max(0.0, std::abs(distance) - s.band.value);
    const CelsiusPerHour speed = distance > 0 ? bench_.estimates.heating : bench_.estimates.cooling;
    temperature_ =
        s.dwell.count() > 0 ? target_ : Celsius{temperature_.value + std::copysign(way, distance)};
    Seconds duration = Seconds{3600.0 * way / speed.value} + s.dwell;
    if (s.dwell.count() > 0) duration += bench_.estimates.settling;
    return std::min(duration, s.timeout);
  }
  Seconds of(const Wait& s) const { return std::max(s.duration, s.operating_time - elapsed_); }
  Seconds of(const Average& s) const { return s.duration; }
  Seconds of(const CompensateField&) const { return bench_.estimates.compensation; }
  Seconds of(const SweepLevel& s) const {
    const auto& coil = s.axis == Axis::kX ? bench_.coil_horizontal : bench_.coil_vertical;
    return coil.device.settle + s.settle + s.duration;
  }
  Seconds of(const Rotate& s) {
    if (s.azimuth == azimuth_ && bench_.turntable.motorised) return Seconds{0.0};
    azimuth_ = s.azimuth;
    return bench_.turntable.motorised ? bench_.turntable.move_time
                                      : bench_.estimates.operator_answer;
  }
  Seconds of(const Prompt&) const { return bench_.estimates.operator_answer; }

  const config::BenchConfig& bench_;
  Celsius target_, temperature_;
  Degree azimuth_{0.0};
  Seconds elapsed_{0.0};
};

}  // namespace

void estimate_durations(std::vector<PlannedStep>& steps, const config::BenchConfig& bench) {
  Estimator estimator(bench);
  for (PlannedStep& step : steps) step.estimate = estimator.step(step);
}

}  // namespace fogbench::procedures
