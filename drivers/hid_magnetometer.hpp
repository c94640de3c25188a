#pragma once
// A three-axis magnetometer that sends HID input reports, laid out as its description says.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/device.hpp"
#include "drivers/instruments.hpp"
#include "drivers/stillness.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

class HidMagnetometer final : public Magnetometer {
 public:
  /// `name` stands in front of every message; `clock` must outlive the magnetometer. Errors:
  /// kBadInput for a layout that lacks an axis or does not fit its report.
  static Result<std::unique_ptr<HidMagnetometer>> attach(std::string name,
                                                         const config::HidDevice& device,
                                                         std::unique_ptr<HidTransport> transport,
                                                         Clock& clock);

  /// Waits for a first report. Errors: as read().
  Status begin() override;

  /// The description's name: the transport has already found the device by its ids.
  Result<std::string> identity() override { return device_.name; }
  /// The next report that was not read before; waits for it. kDevice when an axis is saturated or
  /// the status, where there is one, is not 0; kStale when only old reports came within max_age,
  /// when their count went back, or when all axes have stood still for longer than they may.
  Result<FieldReading> read() override;

 private:
  HidMagnetometer(std::string name, config::HidDevice device,
                  std::unique_ptr<HidTransport> transport, Clock& clock);
  Status check_layout();
  /// Whether the report differs from the last one: by its sequence, else by its bytes.
  bool is_new(const std::vector<std::uint8_t>& report) const;
  /// Whether its count went back since the last one: an old report.
  bool goes_back(const std::vector<std::uint8_t>& report) const;
  Result<FieldReading> decode(std::span<const std::uint8_t> report);
  Error error(ErrorCode code, const std::string& message) const;

  std::string name_;
  config::HidDevice device_;
  std::unique_ptr<HidTransport> transport_;
  Clock& clock_;
  std::array<const config::FieldSpec*, 3> axes_{};  ///< into device_.fields
  const config::FieldSpec* sequence_ = nullptr;
  const config::FieldSpec* status_ = nullptr;
  std::vector<std::uint8_t> last_;  ///< the newest report; empty before the first
  Clock::Instant last_at_{};
  StillnessWatch stillness_;
};

}  // namespace fogbench::drivers
