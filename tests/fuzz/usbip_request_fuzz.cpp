// What a host sends to the USB/IP server: the operations, then transfers for a device.

#include "simulator/wire/usbip_session.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace fogbench::fuzz {
namespace {

using namespace simulator;  // NOLINT(google-build-using-namespace)

UsbDescription any_device() {
  UsbDescription d;
  d.identity = {0x1209, 1, "maker", "thing", "1"};
  d.interface_class = {3, 0, 0};
  d.class_descriptor = {9, 0x21, 0x11, 1, 0, 1, 0x22, 4, 0};
  d.endpoints = {{0x81, 3, 64, 4}, {0x02, 2, 512, 0}};
  return d;
}

/// Echoes: what comes out of it is what went in.
class Echo final : public UsbDevice {
 public:
  Echo() : UsbDevice(any_device()) {}
  bool plugged() const override { return true; }

 private:
  UsbTransfer class_request(const UsbSetup& setup, ByteView data) override {
    if (setup.request == 1) halt(0x81);
    return UsbTransfer::done(Bytes(data.begin(), data.end()));
  }
  UsbTransfer class_descriptor(std::uint16_t) override { return UsbTransfer::done({1, 2, 3, 4}); }
  UsbTransfer take(ByteView data) override {
    said_.assign(data.begin(), data.end());
    return UsbTransfer::done();
  }
  UsbTransfer give(std::size_t most) override {
    if (said_.empty()) return UsbTransfer::in_state(UsbTransfer::State::kBusy);
    Bytes part(said_.begin(),
               said_.begin() + static_cast<std::ptrdiff_t>(std::min(most, said_.size())));
    said_.clear();
    return UsbTransfer::done(std::move(part));
  }
  void forget() override { said_.clear(); }

  Bytes said_;
};

}  // namespace
}  // namespace fogbench::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fogbench;             // NOLINT(google-build-using-namespace)
  using namespace fogbench::simulator;  // NOLINT(google-build-using-namespace)
  const ByteView bytes(data, size);
  if (const auto request = parse_usbip_request(bytes); request && *request) {
    fuzz::require((*request)->size > 0 && (*request)->size <= size);
    fuzz::require((*request)->bus_id.size() <= 32);
  }
  fuzz::Echo device;
  UsbipSession session(device);
  Bytes out;
  for (ByteView rest = bytes;;) {
    const auto command = parse_usbip_command(rest);
    if (!command || !*command) break;
    const UsbipCommand& c = **command;
    fuzz::require(c.size >= kUsbipHeaderBytes && c.size <= rest.size());
    fuzz::require(c.endpoint < 16 && c.length <= kMostTransferBytes);
    if (!session.take(c, rest.subspan(kUsbipHeaderBytes, c.size - kUsbipHeaderBytes))) break;
    if (!session.advance(out)) break;
    rest = rest.subspan(c.size);
  }
  return 0;
}
