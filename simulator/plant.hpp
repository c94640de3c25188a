#pragma once
// Everything that is true on the simulated bench: heat, field, orientation, and what they do to the
// gyro. All far ends share one plant. It moves in steps of its own (config: simulation.step),
// lazily, up to the clock's present; a command takes effect from the next step on.
//
// Not to be used from two threads at once, like the transports in front of it.

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "config/bench.hpp"
#include "config/scenario.hpp"
#include "drivers/clock.hpp"
#include "simulator/hidden_effects.hpp"
#include "simulator/magnetic_physics.hpp"
#include "simulator/thermal_physics.hpp"
#include "simulator/thermostat_controller.hpp"

namespace fogbench::simulator {

/// What the gyro feels during one step, before its noise.
struct GyroInput {
  double rate_deg_per_h = 0.0;
  double temperature_c = 0.0;
};

class Plant {
 public:
  /// How long the gyro's past is kept for a reader that is away: what a host's receiving thread
  /// buffers at most.
  static constexpr double kKeptS = 600.0;

  /// The clock's present is the power-on, and must outlive the plant. kBadInput for an effect or
  /// parameter that does not exist and for a step outside (0, 1] s.
  static Result<std::unique_ptr<Plant>> create(const config::BenchConfig& bench,
                                               const config::ScenarioConfig& scenario,
                                               std::uint64_t seed, const drivers::Clock& clock);

  /// Steps until the plant's time is not before the clock's.
  void advance();

  /// Of the clock, since power-on.
  double now_s() const;
  double step_s() const { return step_s_; }
  const TrueState& state() const { return state_; }
  ThermostatController& thermostat() { return thermostat_; }
  const ThermostatController& thermostat() const { return thermostat_; }
  MagneticPhysics& magnetic() { return magnetic_; }
  /// The heaters' circuit is open: the controller drives them in vain.
  void open_heaters(bool open) { heaters_open_ = open; }

  /// Gyro axes.
  Vector3 field_ut() const;

  /// What a sensor of that channel reads now, noise included; nothing where the bench has none.
  std::optional<double> auxiliary(std::string_view channel);
  bool has_auxiliary(std::string_view channel) const { return auxiliary_.contains(channel); }

  /// The turntable starts to move, a quarter turn in `move_time` of the bench's configuration.
  void rotate_to(double azimuth_deg);
  /// Another gyro of the same kind, switched on now: its effects have no past.
  void exchange_gyro();
  /// A hand has turned the gyro: it stands there now.
  void turned_to(double azimuth_deg);
  /// As its encoder says; the true azimuth differs by the repeatability.
  double encoder_deg() const { return encoder_deg_; }

  // Step k covers the time from k to k + 1 steps after power-on.
  /// The end of the last step.
  double reached_s() const { return static_cast<double>(steps_) * step_s_; }
  std::int64_t first_kept_step() const { return first_kept_step_; }
  /// Precondition: first_kept_step() <= step, and advance() has covered the step.
  const GyroInput& gyro_input(std::int64_t step) const {
    return gyro_inputs_[static_cast<std::size_t>(step - first_kept_step_)];
  }
  /// The gyro has passed these steps.
  void forget_before(std::int64_t step);

 private:
  Plant(const config::BenchConfig& bench, HiddenEffects effects, double reference_temperature_c,
        std::uint64_t seed, const drivers::Clock& clock);
  void step();
  /// Fills state_ from the parts.
  void observe();

  const drivers::Clock& clock_;
  const drivers::Clock::Instant power_on_;
  const config::SimulationConfig config_;
  const double step_s_;
  const double turn_deg_per_step_;
  ThermalPhysics thermal_;
  ThermostatController thermostat_;
  MagneticPhysics magnetic_;
  HiddenEffects effects_;
  const HiddenEffects fresh_effects_;  ///< as a gyro comes
  std::int64_t gyro_since_ = 0;        ///< the step in which the present one was switched on
  NormalSource turntable_noise_;
  bool heaters_open_ = false;
  struct Auxiliary {
    config::SimulatedQuantity goes;
    NormalSource noise;
  };
  std::map<std::string, Auxiliary, std::less<>> auxiliary_;
  double encoder_deg_ = 0.0;
  double encoder_target_deg_ = 0.0;
  double azimuth_error_deg_ = 0.0;
  TrueState state_;
  std::int64_t steps_ = 0;
  std::int64_t first_kept_step_ = 0;
  std::deque<GyroInput> gyro_inputs_;
};

}  // namespace fogbench::simulator
