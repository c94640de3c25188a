#include "drivers/scpi_coil_supply.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fogbench::drivers {
namespace {

/// One read-back that is off may be the read-back's fault; two are the output's.
constexpr int kLooks = 2;

}  // namespace

Result<std::unique_ptr<ScpiCoilSupply>> ScpiCoilSupply::attach(
    std::string name, const config::CoilConfig& config, std::unique_ptr<MessageTransport> transport,
    Clock& clock) {
  auto dialogue = ScpiDialogue::attach(std::move(name), config.device, std::move(transport), clock);
  if (!dialogue) return dialogue.error();
  return std::unique_ptr<ScpiCoilSupply>(new ScpiCoilSupply(std::move(*dialogue), config, clock));
}

Status ScpiCoilSupply::begin() {
  if (Status begun = dialogue_.begin(); !begun) return begun;
  if (Status sent = switch_off(); !sent) return sent;
  return confirm_off();
}

Status ScpiCoilSupply::program(double current_a) {
  // Whether or not it is obeyed, the output may be changing from now on.
  Status done = dialogue_.set(current_a);
  settle();
  return done;
}

void ScpiCoilSupply::settle() {
  valid_from_ = clock_.now() + from_seconds(config_.device.settle.count());
}

Status ScpiCoilSupply::verify(double set_a,
                              Result<double> (ScpiDialogue::*measure)(const std::string&)) {
  double measured_a = 0.0;
  for (int look = 0; look < kLooks; ++look) {
    clock_.sleep_until(valid_from_);
    const auto measured = (dialogue_.*measure)(config_.device.measure_query);
    if (!measured) return measured.error();
    measured_a = *measured;
    if (std::abs(measured_a - set_a) <= config_.device.read_back_tolerance) return {};
    settle();
  }
  return dialogue_.error(
      ErrorCode::kDevice,
      fmt::format("was set to {:.6f} A but measures {:.6f} A, more than {} A apart", set_a,
                  measured_a, config_.device.read_back_tolerance));
}

Status ScpiCoilSupply::enable() {
  if (Status zero = program(0.0); !zero) return zero;
  if (!config_.device.output_on.empty()) {
    if (Status on = dialogue_.command(config_.device.output_on); !on) return on;
    settle();
  }
  return verify(0.0, &ScpiDialogue::query_value);
}

Status ScpiCoilSupply::set_current(Ampere current) {
  const double limit = config_.current_limit.value;
  const double lowest = std::max(-limit, config_.device.minimum);
  const double highest = std::min(limit, config_.device.maximum);
  if (!(current.value >= lowest && current.value <= highest)) {
    return dialogue_.error(ErrorCode::kLimit, fmt::format("current {} A is outside {} ... {} A",
                                                          current.value, lowest, highest));
  }
  const double step = config_.device.resolution;
  const double rounded = step > 0 ? std::round(current.value / step) * step : current.value;
  const double set_a = std::clamp(rounded, lowest, highest);
  if (Status done = program(set_a); !done) return done;
  return verify(set_a, &ScpiDialogue::query_value);
}

Result<CoilReading> ScpiCoilSupply::read() {
  clock_.sleep_until(valid_from_);
  const auto measured = dialogue_.query_value(config_.device.measure_query);
  if (!measured) return measured.error();
  const auto set = dialogue_.query_value(config_.device.set_query);
  if (!set) return set.error();
  return CoilReading{.taken_at = clock_.now(), .set = Ampere{*set}, .measured = Ampere{*measured}};
}

Status ScpiCoilSupply::switch_off() {
  Status first_failure = dialogue_.tell_value(0.0);
  settle();
  if (!config_.device.output_off.empty()) {
    const Status off = dialogue_.tell(config_.device.output_off);
    if (first_failure) first_failure = off;
  }
  return first_failure;
}

Status ScpiCoilSupply::confirm_off() {
  if (Status zero = verify(0.0, &ScpiDialogue::look); !zero) return zero;
  const std::string refused = dialogue_.refused();
  if (refused.empty()) return {};
  return dialogue_.error(ErrorCode::kDevice, "switching off was refused: " + refused);
}

}  // namespace fogbench::drivers
