// A magnetometer whose reports are any bytes of any length.

#include <cmath>

#include "drivers/hid_magnetometer.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace fogbench::fuzz {
namespace {

using drivers::Clock;

class Reports final : public drivers::HidTransport {
 public:
  Reports(Input& input, Clock& clock) : input_(input), clock_(clock) {}
  Result<std::size_t> read_report(std::span<std::uint8_t> out, Clock::Duration timeout) override {
    require(++reads_ < 100000);
    if (input_.empty()) return Error{ErrorCode::kDevice, "gone"};
    const std::uint8_t length = input_.byte();
    if (length == 0xFF) {
      clock_.sleep_for(timeout);
      return Error{ErrorCode::kTimeout, "no report"};
    }
    const auto bytes = input_.bytes(std::min<std::size_t>(length, out.size()));
    std::copy(bytes.begin(), bytes.end(), out.begin());
    return std::size_t{length};
  }
  Status write_report(std::span<const std::uint8_t>) override { return {}; }

 private:
  Input& input_;
  Clock& clock_;
  int reads_ = 0;
};

config::HidDevice layout(Input& input) {
  using config::NumberType;
  config::HidDevice device;
  device.name = "any";
  device.report_id = 1;
  device.report_bytes = 16;
  device.range = config::Microtesla{600.0};
  device.stuck_after = config::Seconds{3.0};
  const bool floats = input.byte() % 2 == 1;
  const char* const names[] = {"field_x", "field_y", "field_z"};
  for (std::uint16_t i = 0; i < 3; ++i) {
    device.fields.push_back({names[i], static_cast<std::uint16_t>(1 + 4 * i),
                             floats ? NumberType::kFloat32 : NumberType::kInt32,
                             floats ? 1.0 : 1e-4, 0.0, "uT"});
  }
  const auto type = static_cast<NumberType>(input.byte() % 4);  // of one or two bytes
  device.fields.push_back({"sequence", 13, type, 1.0, 0.0, ""});
  device.fields.push_back({"status", 15, NumberType::kUint8, 1.0, 0.0, ""});
  return device;
}

}  // namespace
}  // namespace fogbench::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fogbench;  // NOLINT(google-build-using-namespace)
  fuzz::Input input(data, size);
  const config::HidDevice device = fuzz::layout(input);
  drivers::VirtualClock clock;
  auto magnetometer = drivers::begun(drivers::HidMagnetometer::attach(
      "magnetometer", device, std::make_unique<fuzz::Reports>(input, clock), clock));
  while (magnetometer && !input.empty()) {
    clock.sleep_for(std::chrono::milliseconds{input.byte() * 10});
    const auto reading = (*magnetometer)->read();
    if (!reading) {
      fuzz::require(reading.error().message.starts_with("magnetometer: "));
      continue;
    }
    for (const auto& axis : reading->field) fuzz::require(std::abs(axis.value) < 600.0);
  }
  return 0;
}
