// A supply whose USB answers anything at all: what stands in front of an answer, and the whole
// conversation with its aborts, clears and status bytes.

#include <algorithm>
#include <chrono>

#include "drivers/usbtmc.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace fogbench::fuzz {
namespace {

using namespace drivers::usbtmc;  // NOLINT(google-build-using-namespace): this file's vocabulary
using drivers::Clock;

constexpr std::size_t kPacketBytes = 64;

/// Every call takes its answer from the input; a first byte below the number of failures is one.
/// After the end the device is gone.
class AnyUsb final : public drivers::UsbBulk {
 public:
  explicit AnyUsb(Input& input) : input_(input) {}

  Status bulk_out(std::span<const std::uint8_t> bytes, Clock::Duration) override {
    require(bytes.size() >= kHeaderBytes && bytes.size() % 4 == 0);
    tag_ = bytes[1];
    require(tag_ != 0);
    return next();
  }
  Result<std::size_t> bulk_in(std::span<std::uint8_t> out, Clock::Duration) override {
    require(!out.empty());
    if (Status usb = next(); !usb) return usb.error();
    // An honest header now and then, with the tag that is awaited: the rest is met behind it.
    const std::uint8_t kind = input_.byte();
    std::size_t count = 0;
    if (kind < 128 && out.size() > kHeaderBytes) {
      const auto header = encode_request(tag_, kind % 64);
      count = header.size();
      std::copy(header.begin(), header.end(), out.begin());
      out[8] = kind / 64;
    }
    const auto bytes = input_.bytes(std::min<std::size_t>(input_.byte(), out.size() - count));
    std::copy(bytes.begin(), bytes.end(), out.begin() + static_cast<std::ptrdiff_t>(count));
    return count + bytes.size();
  }
  Result<std::size_t> control_in(std::uint8_t, std::uint16_t, Recipient,
                                 std::span<std::uint8_t> out, Clock::Duration) override {
    if (Status usb = next(); !usb) return usb.error();
    const std::size_t count = take(out);
    // Every look at an abort that is pending takes its pause in real time: few are enough.
    if (count > 0 && out[0] == kPending && ++pendings_ > kMostPendings) out[0] = kSuccess;
    return count;
  }
  Status clear_halt(Recipient) override { return next(); }
  bool has_interrupt_in() const override { return has_interrupt_; }
  Result<std::size_t> interrupt_in(std::span<std::uint8_t> out, Clock::Duration) override {
    if (Status usb = next(); !usb) return usb.error();
    return take(out);
  }
  std::size_t packet_bytes() const override { return kPacketBytes; }

  bool has_interrupt_ = false;

 private:
  static constexpr int kMostPendings = 3;

  Status next() {
    if (input_.empty()) return Error{ErrorCode::kUnplugged, "gone"};
    constexpr ErrorCode kFailures[] = {ErrorCode::kTimeout, ErrorCode::kProtocol,
                                       ErrorCode::kUnplugged};
    const std::uint8_t choice = input_.byte();
    if (choice < 3) return Error{kFailures[choice], "the bus fails"};
    return {};
  }
  std::size_t take(std::span<std::uint8_t> out) {
    const auto bytes = input_.bytes(std::min<std::size_t>(input_.byte(), out.size()));
    std::copy(bytes.begin(), bytes.end(), out.begin());
    return bytes.size();
  }

  Input& input_;
  std::uint8_t tag_ = 0;
  int pendings_ = 0;
};

}  // namespace
}  // namespace fogbench::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fogbench;                   // NOLINT(google-build-using-namespace)
  using namespace fogbench::drivers::usbtmc;  // NOLINT(google-build-using-namespace)
  constexpr std::uint32_t kMost = 4096;
  if (const auto header = decode_answer_header({data, size}, kMost)) {
    fuzz::require(size >= kHeaderBytes && data[0] == kDevDepMsgIn);
    fuzz::require(header->tag != 0 && header->size <= kMost);
  }
  fuzz::Input input(data, size);
  fuzz::AnyUsb usb(input);
  usb.has_interrupt_ = input.byte() % 2 == 1;
  drivers::Usbtmc talk(usb);
  while (!input.empty()) {
    const std::uint8_t choice = input.byte() % 8;
    if (choice == 0) {
      (void)talk.clear();
    } else if (choice == 1) {
      (void)talk.status_byte();
    } else if (choice < 4) {
      (void)talk.write("CURR 1.5", std::chrono::seconds{1});
    } else if (const auto answer = talk.read(std::chrono::seconds{1})) {
      fuzz::require(!answer->ends_with('\n'));
    }
  }
  return 0;
}
