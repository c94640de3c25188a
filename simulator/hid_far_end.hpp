#pragma once
// The magnetometer, or an auxiliary sensor, at its HID input reports: one each report period,
// counted by the field `sequence`, laid out as the instrument's description says. Reported is
// matrix * true field (gyro axes) + offset + noise, limited to the range.

#include <cstdint>
#include <optional>
#include <span>

#include "config/bench.hpp"
#include "drivers/transport.hpp"
#include "simulator/instrument_line.hpp"

namespace fogbench::simulator {

class HidFarEnd final : public drivers::HidTransport {
 public:
  static constexpr std::initializer_list<FaultKind> kFaults = {
      FaultKind::kTimeout,   FaultKind::kLateAnswer, FaultKind::kBadSequence,
      FaultKind::kGarbage,   FaultKind::kNan,        FaultKind::kStuck,
      FaultKind::kException, FaultKind::kUnplug,     FaultKind::kSlowAnswer};

  HidFarEnd(const config::HidDevice& device, const config::MagneticPlant& plant,
            InstrumentLine line, std::uint64_t seed);

  Result<std::size_t> read_report(std::span<std::uint8_t> out,
                                  drivers::Clock::Duration timeout) override;
  /// Takes every output report and does nothing.
  Status write_report(std::span<const std::uint8_t> report) override;
  bool plugged() const { return line_.plugged(); }
  void set_fault(FaultKind kind, bool on) { line_.set_fault(kind, on); }

 private:
  /// Number of the newest report that exists; 0 is none.
  std::int64_t newest() const;
  /// What the sensor says of the true field.
  Vector3 measure(std::int64_t number);
  void encode(std::int64_t number, std::span<std::uint8_t> report);

  const config::HidDevice device_;
  const config::MagneticPlant plant_config_;
  InstrumentLine line_;
  const std::uint64_t seed_;
  std::int64_t last_read_ = 0;
  std::optional<Vector3> last_measured_;  ///< what a stuck sensor says again
};

}  // namespace fogbench::simulator
