#pragma once
// An auxiliary sensor that sends lines of text unasked, one each period: its channels' numbers at
// their positions, zeros at the others.

#include <cstddef>
#include <span>
#include <string>

#include "config/sensor.hpp"
#include "drivers/transport.hpp"
#include "simulator/instrument_line.hpp"

namespace fogbench::simulator {

class LineFarEnd final : public drivers::SerialTransport {
 public:
  static constexpr std::initializer_list<FaultKind> kFaults = {
      FaultKind::kTimeout, FaultKind::kGarbage, FaultKind::kNan, FaultKind::kUnplug};

  LineFarEnd(const config::LineSensor& sensor, InstrumentLine line)
      : sensor_(sensor), line_(std::move(line)) {}

  Result<std::size_t> read_some(std::span<std::byte> out) override;
  /// Takes every command and does nothing.
  Status write(std::span<const std::byte> bytes) override;
  bool plugged() const { return line_.plugged(); }
  void set_fault(FaultKind kind, bool on) { line_.set_fault(kind, on); }

 private:
  std::string make_line();

  const config::LineSensor sensor_;
  InstrumentLine line_;
  std::int64_t sent_ = 0;  ///< number of the last line
  std::string pending_;
};

}  // namespace fogbench::simulator
