#include "drivers/turntables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "drivers/named_error.hpp"

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;

constexpr Clock::Duration kLookEvery = 500ms;
constexpr int kPatience = 3;  ///< times the usual time of a move

}  // namespace

Result<std::unique_ptr<ScpiTurntable>> ScpiTurntable::attach(
    std::string name, const config::TurntableConfig& config,
    std::unique_ptr<MessageTransport> transport, Clock& clock) {
  if (!config.device) {
    return Error{ErrorCode::kBadInput, name + ": is motorised but has no device description"};
  }
  auto dialogue =
      ScpiDialogue::attach(std::move(name), *config.device, std::move(transport), clock);
  if (!dialogue) return dialogue.error();
  return std::unique_ptr<ScpiTurntable>(new ScpiTurntable(std::move(*dialogue), config, clock));
}

Status ScpiTurntable::rotate_to(Degree azimuth) {
  if (!(azimuth.value >= device_.minimum && azimuth.value <= device_.maximum)) {
    return dialogue_.error(ErrorCode::kLimit,
                           fmt::format("azimuth {} deg is outside {} ... {} deg", azimuth.value,
                                       device_.minimum, device_.maximum));
  }
  const double step = device_.resolution;
  const double rounded = step > 0 ? std::round(azimuth.value / step) * step : azimuth.value;
  if (Status done = dialogue_.set(std::clamp(rounded, device_.minimum, device_.maximum)); !done) {
    return done;
  }
  const Clock::Instant give_up = clock_.now() + kPatience * move_time_;
  clock_.sleep_for(from_seconds(device_.settle.count()));
  for (;;) {
    const auto reached = dialogue_.query_value(device_.measure_query);
    if (!reached) return reached.error();
    if (config::angle_between(Degree{*reached}, azimuth).value <= device_.read_back_tolerance) {
      return {};
    }
    if (clock_.now() >= give_up) {
      return dialogue_.error(
          ErrorCode::kTimeout,
          fmt::format("stands at {} deg {:.0f} s after it was sent to {} deg", *reached,
                      to_seconds(kPatience * move_time_), azimuth.value));
    }
    clock_.sleep_for(kLookEvery);
  }
}

Result<Degree> ScpiTurntable::azimuth() {
  const auto azimuth = dialogue_.query_value(device_.measure_query);
  if (!azimuth) return azimuth.error();
  return Degree{*azimuth};
}

Status ManualTurntable::rotate_to(Degree azimuth) {
  if (azimuth == azimuth_) return {};
  const auto done = operator_.confirm(fmt::format(
      "Turn the gyro from azimuth {} deg to {} deg, then confirm.", azimuth_.value, azimuth.value));
  if (!done) return named(name_, done.error());
  if (!*done) {
    return Error{
        ErrorCode::kAborted,
        fmt::format("{}: the operator declined to turn the gyro to {} deg", name_, azimuth.value)};
  }
  azimuth_ = azimuth;
  if (turned_) turned_(azimuth.value);
  return {};
}

}  // namespace fogbench::drivers
