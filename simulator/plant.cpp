#include "simulator/plant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fogbench::simulator {
namespace {

constexpr double kQuarterTurnDeg = 90.0;

}  // namespace

Result<std::unique_ptr<Plant>> Plant::create(const config::BenchConfig& bench,
                                             const config::ScenarioConfig& scenario,
                                             std::uint64_t seed, const drivers::Clock& clock) {
  const double step_s = bench.simulation.step.count();
  if (!(step_s > 0.0 && step_s <= 1.0)) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("bench: simulation step is {} s, expected 0 < step <= 1 s", step_s)};
  }
  Result<HiddenEffects> effects = HiddenEffects::create(scenario);
  if (!effects) return effects.error();
  const auto channels = config::auxiliary_channels(bench);
  for (const HiddenEffects::OnChannel& acts : effects->on_channels()) {
    if (std::any_of(channels.begin(), channels.end(),
                    [&](const auto& known) { return known.name == acts.channel; })) {
      continue;
    }
    return Error{ErrorCode::kBadInput,
                 fmt::format("{}: {}: no auxiliary sensor of the bench {} measures {}", acts.where,
                             acts.effect, bench.name, acts.channel)};
  }
  return std::unique_ptr<Plant>(
      new Plant(bench, *std::move(effects), scenario.reference_temperature.value, seed, clock));
}

Plant::Plant(const config::BenchConfig& bench, HiddenEffects effects,
             double reference_temperature_c, std::uint64_t seed, const drivers::Clock& clock)
    : clock_(clock),
      power_on_(clock.now()),
      config_(bench.simulation),
      step_s_(bench.simulation.step.count()),
      turn_deg_per_step_(kQuarterTurnDeg * step_s_ /
                         std::max(bench.turntable.move_time.count(), step_s_)),
      thermal_(bench.simulation.thermal, step_s_),
      thermostat_(bench.simulation.thermal, step_s_, derive_seed(seed, "thermostat sensors")),
      magnetic_(bench.simulation.magnetic, step_s_, derive_seed(seed, "ambient field steps")),
      effects_(effects),
      fresh_effects_(std::move(effects)),
      turntable_noise_(derive_seed(seed, "turntable")) {
  state_.step_s = step_s_;
  state_.reference_temperature_c = reference_temperature_c;
  for (const config::SensorChannel& channel : config::auxiliary_channels(bench)) {
    auxiliary_.emplace(channel.name,
                       Auxiliary{channel.simulated, NormalSource(derive_seed(seed, channel.name))});
  }
  observe();
}

double Plant::now_s() const {
  return drivers::to_seconds(clock_.now() - power_on_);
}

void Plant::advance() {
  const double now = now_s();
  while (static_cast<double>(steps_) * step_s_ < now) step();
}

Vector3 Plant::field_ut() const {
  return to_gyro_axes(magnetic_.field_ut(), state_.azimuth_deg);
}

std::optional<double> Plant::auxiliary(std::string_view channel) {
  const auto found = auxiliary_.find(channel);
  if (found == auxiliary_.end()) return std::nullopt;
  Auxiliary& its = found->second;
  return its.goes.mean + state_.auxiliary.find(channel)->second + its.goes.noise * its.noise();
}

void Plant::rotate_to(double azimuth_deg) {
  encoder_target_deg_ = azimuth_deg;
  azimuth_error_deg_ = config_.turntable_repeatability.value * turntable_noise_();
}

void Plant::exchange_gyro() {
  advance();
  effects_ = fresh_effects_;
  gyro_since_ = steps_;
}

void Plant::turned_to(double azimuth_deg) {
  rotate_to(azimuth_deg);
  encoder_deg_ = azimuth_deg;
}

void Plant::step() {
  ++steps_;
  const HeaterPower power = heaters_open_ ? HeaterPower{} : thermostat_.power();
  thermal_.advance(power);
  thermostat_.advance(thermal_);
  magnetic_.advance();
  encoder_deg_ +=
      std::clamp(encoder_target_deg_ - encoder_deg_, -turn_deg_per_step_, turn_deg_per_step_);

  state_.heater_w = power.total_w();
  observe();
  gyro_inputs_.push_back(
      {config_.earth_rate_on_axis.value + effects_.advance(state_), thermal_.coil_c()});
  forget_before(steps_ - static_cast<std::int64_t>(kKeptS / step_s_));
}

void Plant::observe() {
  state_.time_s = static_cast<double>(steps_ - gyro_since_) * step_s_;
  state_.temperature_c = thermal_.carrier_c();
  state_.temperature_rate_c_per_h = thermal_.carrier_rate_c_per_h();
  state_.temperature_acceleration_c_per_h2 = thermal_.carrier_acceleration_c_per_h2();
  state_.temperature_gradient_c = thermal_.gradient_c();
  state_.ambient_c = thermal_.ambient_c();
  state_.azimuth_deg = encoder_deg_ + azimuth_error_deg_;
  state_.field_100ut = field_ut();
  for (double& h : state_.field_100ut) h /= 100.0;
  for (const auto& [name, its] : auxiliary_) {
    const double turns = static_cast<double>(steps_) * step_s_ / its.goes.period.count();
    state_.auxiliary[name] = its.goes.swing * std::sin(2.0 * std::numbers::pi * turns);
  }
  state_.sum_squared_current_a2 = magnetic_.sum_squared_current_a2();
}

void Plant::forget_before(std::int64_t step) {
  while (first_kept_step_ < std::min(step, steps_)) {
    gyro_inputs_.pop_front();
    ++first_kept_step_;
  }
}

}  // namespace fogbench::simulator
