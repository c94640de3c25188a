#pragma once
// A SCPI instrument at its messages: the dialogue of its description (set, query, measure, output)
// over something that it drives, the common commands *IDN? *CLS *RST, and the error queue.
//
// Errors as IEEE 488.2 / SCPI-99 number them: -113 undefined header (the self test too: there is
// none), -109 missing parameter, -120 numeric data error, -200 execution error, -222 data out of
// range, -410 a query whose answer was not read, -420 a read with nothing to say. After -222 the
// output stays as it was.

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "config/device.hpp"
#include "config/sensor.hpp"
#include "drivers/transport.hpp"
#include "simulator/instrument_line.hpp"

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

class ScpiFarEnd final : public drivers::MessageTransport {
 public:
  static constexpr std::initializer_list<FaultKind> kFaults = {
      FaultKind::kTimeout,     FaultKind::kLateAnswer, FaultKind::kSilentExecution,
      FaultKind::kBadSequence, FaultKind::kGarbage,    FaultKind::kNan,
      FaultKind::kStuck,       FaultKind::kException,  FaultKind::kUnplug,
      FaultKind::kSlowAnswer};
  /// Of a supply: a turntable's motor has no circuit that matters here.
  static constexpr std::initializer_list<FaultKind> kSupplyFaults = {
      FaultKind::kTimeout,     FaultKind::kLateAnswer, FaultKind::kSilentExecution,
      FaultKind::kBadSequence, FaultKind::kGarbage,    FaultKind::kNan,
      FaultKind::kStuck,       FaultKind::kException,  FaultKind::kUnplug,
      FaultKind::kSlowAnswer,  FaultKind::kOpenCircuit};

  ScpiFarEnd(const config::ScpiDevice& device, std::unique_ptr<ScpiOutput> output,
             InstrumentLine line);

  Status write(std::string_view message) override;
  Result<std::string> read(drivers::Clock::Duration timeout) override;
  Status clear() override;
  /// As a serial poll reads it, IEEE 488.2: bit 4 an answer waits, bit 2 an error is queued.
  Result<std::uint8_t> read_status_byte();
  bool plugged() const { return line_.plugged(); }
  void set_fault(FaultKind kind, bool on) { line_.set_fault(kind, on); }
  /// Called with every message that reaches it.
  void on_message(std::function<void(std::string_view)> hears) { hears_ = std::move(hears); }

 private:
  /// What the scenario calls this message; a message and the reading of its answer are one
  /// operation.
  std::string_view operation_of(std::string_view message) const;
  void execute(std::string_view command);
  void answer(std::string text);
  void set(std::string_view argument);
  void fail(int number, const char* meaning);
  /// A number as the instrument writes it; `last` is what a stuck one says again.
  std::string number(double value, std::optional<std::string>& last);
  std::string next_error();

  const config::ScpiDevice device_;
  std::unique_ptr<ScpiOutput> output_;
  InstrumentLine line_;
  std::function<void(std::string_view)> hears_;
  std::deque<std::string> errors_;
  std::optional<std::string> answer_;
  std::optional<std::string> last_setpoint_, last_measurement_;
};

}  // namespace fogbench::simulator
