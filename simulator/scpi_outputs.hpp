#pragma once
// What the bench's SCPI instruments drive, a coil pair's current, the turntable, or measure.

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "config/device.hpp"
#include "config/sensor.hpp"
#include "simulator/magnetic_physics.hpp"
#include "simulator/plant.hpp"

namespace fogbench::simulator {

/// What a SCPI instrument drives.
class ScpiOutput {
 public:
  virtual ~ScpiOutput() = default;
  /// Precondition: within the instrument's range.
  virtual void set(Plant& plant, double value) = 0;
  virtual double setpoint() const = 0;
  virtual double measure(const Plant& plant) = 0;
  virtual void switch_output(Plant& plant, bool on) = 0;
  /// The number that answers a question of its own; nothing for what is no such question.
  virtual std::optional<double> answer_to(Plant& /*plant*/, std::string_view /*question*/) {
    return std::nullopt;
  }
  /// The circuit that it drives is open, or whole again.
  virtual void open_circuit(Plant& /*plant*/, bool /*open*/) {}
};

/// One pair's bipolar current source: 15 bits and a sign; with the output off it programs zero.
std::unique_ptr<ScpiOutput> make_supply_output(const config::ScpiDevice& device,
                                               MagneticPhysics::Pair pair, double bits,
                                               std::uint64_t seed);
/// A sensor, which drives nothing and answers the questions of its description.
std::unique_ptr<ScpiOutput> make_sensor_output(const config::ScpiSensor& sensor);
/// The turntable's motor.
std::unique_ptr<ScpiOutput> make_turntable_output();

}  // namespace fogbench::simulator
