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
#include "drivers/transport.hpp"
#include "simulator/instrument_line.hpp"
#include "simulator/scpi_outputs.hpp"

namespace fogbench::simulator {

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
