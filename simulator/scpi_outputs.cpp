#include "simulator/scpi_outputs.hpp"

#include <algorithm>
#include <utility>

namespace fogbench::simulator {
namespace {

class SupplyOutput final : public ScpiOutput {
 public:
  SupplyOutput(const config::ScpiDevice& device, MagneticPhysics::Pair pair, double bits,
               std::uint64_t seed)
      : full_scale_a_(std::max(-device.minimum, device.maximum)),
        settle_s_(device.settle.count()),
        pair_(pair),
        bits_(bits),
        noise_(seed) {}

  void set(Plant& plant, double value) override {
    setpoint_a_ = value;
    if (on_) program(plant, value);
  }

  double setpoint() const override { return setpoint_a_; }

  /// The mean over the last settling time: valid that long after the last change.
  double measure(const Plant& plant) override {
    const double elapsed =
        settle_s_ > 0.0 ? std::min(1.0, (plant.now_s() - changed_at_s_) / settle_s_) : 1.0;
    const double mean_a = before_a_ + elapsed * (output_a_ - before_a_);
    // The read-back converter has the output's resolution, and one count of noise.
    const double noise_a = full_scale_a_ / 32768.0 * noise_();
    return quantise_current(mean_a + noise_a, full_scale_a_, bits_);
  }

  void switch_output(Plant& plant, bool on) override {
    on_ = on;
    if (!on) setpoint_a_ = 0.0;
    program(plant, setpoint_a_);
  }

  /// Whatever the voltage, no current flows.
  void open_circuit(Plant& plant, bool open) override {
    if (std::exchange(open_, open) != open) program(plant, on_ ? setpoint_a_ : 0.0);
  }

 private:
  void program(Plant& plant, double current_a) {
    before_a_ = output_a_;
    output_a_ = open_ ? 0.0 : quantise_current(current_a, full_scale_a_, bits_);
    changed_at_s_ = plant.now_s();
    // 16 time constants: settled to 1e-7 when the read-back becomes valid.
    plant.magnetic().program(pair_, output_a_, settle_s_ / 16.0);
  }

  const double full_scale_a_;
  const double settle_s_;
  const MagneticPhysics::Pair pair_;
  const double bits_;
  NormalSource noise_;
  bool on_ = false;
  bool open_ = false;
  double setpoint_a_ = 0.0;
  double before_a_ = 0.0;
  double output_a_ = 0.0;
  double changed_at_s_ = 0.0;
};

class TurntableOutput final : public ScpiOutput {
 public:
  void set(Plant& plant, double value) override {
    setpoint_deg_ = value;
    plant.rotate_to(value);
  }
  double setpoint() const override { return setpoint_deg_; }
  double measure(const Plant& plant) override { return plant.encoder_deg(); }
  void switch_output(Plant& plant, bool on) override {
    if (!on) plant.rotate_to(plant.encoder_deg());  // The motor holds where it is.
  }

 private:
  double setpoint_deg_ = 0.0;
};

class SensorOutput final : public ScpiOutput {
 public:
  explicit SensorOutput(config::ScpiSensor sensor) : sensor_(std::move(sensor)) {}

  void set(Plant& /*plant*/, double /*value*/) override {}
  double setpoint() const override { return 0.0; }
  double measure(const Plant& /*plant*/) override { return 0.0; }
  void switch_output(Plant& /*plant*/, bool /*on*/) override {}
  std::optional<double> answer_to(Plant& plant, std::string_view question) override {
    for (const config::QueryChannel& channel : sensor_.channels) {
      if (channel.query != question) continue;
      const auto value = plant.auxiliary(channel.name);
      if (value) return (*value - channel.offset) / channel.scale;
    }
    return std::nullopt;
  }

 private:
  const config::ScpiSensor sensor_;
};

}  // namespace

std::unique_ptr<ScpiOutput> make_supply_output(const config::ScpiDevice& device,
                                               MagneticPhysics::Pair pair, double bits,
                                               std::uint64_t seed) {
  return std::make_unique<SupplyOutput>(device, pair, bits, seed);
}

std::unique_ptr<ScpiOutput> make_sensor_output(const config::ScpiSensor& sensor) {
  return std::make_unique<SensorOutput>(sensor);
}

std::unique_ptr<ScpiOutput> make_turntable_output() {
  return std::make_unique<TurntableOutput>();
}

}  // namespace fogbench::simulator
