#pragma once
// The far end of USBTMC as a script: an instrument that answers questions, and what can go wrong on
// its bulk and control endpoints.

#include <algorithm>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/number_codec.hpp"
#include "drivers/usbtmc.hpp"

namespace fogbench::support {

class FakeUsb final : public drivers::UsbBulk {
 public:
  using Bytes = std::vector<std::uint8_t>;

  // What the test sets.
  std::map<std::string, std::string> answers;  ///< by message, line feed included
  std::size_t most_per_answer = 4096;          ///< longer ones come in several
  std::optional<Error> gone;                   ///< what every call fails with
  std::optional<Error> out_failure;            ///< what the next bulk_out fails with
  bool silent = false;                         ///< requests are heard, not answered
  bool stalls_controls = false;
  int pending = 0;  ///< how often a check says that it is not done yet
  std::uint8_t abort_status = drivers::usbtmc::kSuccess;
  std::uint8_t clear_status = drivers::usbtmc::kSuccess;
  std::uint8_t status = 0x10;
  bool interrupt_endpoint = false;
  std::deque<Bytes> transfers;        ///< what bulk-in holds, in front of any answer
  Bytes held;                         ///< what bulk-in holds as soon as an abort begins
  std::deque<Bytes> interrupts;       ///< what comes before the status byte
  std::function<void(Bytes&)> spoil;  ///< changes each answer on its way

  // What the test sees.
  std::vector<std::string> messages;
  std::vector<int> requests;  ///< the control requests' numbers
  int halts_cleared = 0;
  std::string pending_answer;

  /// An answer's transfer, padded.
  static Bytes answer(std::uint8_t tag, const std::string& text, bool is_last = true) {
    Bytes bytes((12 + text.size() + 3) / 4 * 4);
    bytes[0] = 2;
    bytes[1] = tag;
    bytes[2] = static_cast<std::uint8_t>(~tag);
    drivers::store_bytes(bytes.data() + 4, 4, drivers::ByteOrder::kLittleEndian,
                         static_cast<std::uint32_t>(text.size()));
    bytes[8] = is_last ? 1 : 0;
    std::copy(text.begin(), text.end(), bytes.begin() + 12);
    return bytes;
  }
  std::uint8_t last_tag() const { return tag_; }

  Status bulk_out(std::span<const std::uint8_t> bytes, drivers::Clock::Duration) override {
    if (gone) return *gone;
    if (out_failure) return *std::exchange(out_failure, std::nullopt);
    if (bytes.size() % 4 != 0 || bytes.size() < 12) return Error{ErrorCode::kProtocol, "framing"};
    tag_ = bytes[1];
    if (bytes[2] != static_cast<std::uint8_t>(~tag_)) return Error{ErrorCode::kProtocol, "tag"};
    const auto size = drivers::load_bytes(bytes.data() + 4, 4, drivers::ByteOrder::kLittleEndian);
    if (bytes[0] == 1) {
      messages.emplace_back(bytes.begin() + 12, bytes.begin() + 12 + size);
      const auto known = answers.find(messages.back());
      if (known != answers.end()) pending_answer = known->second;
    } else if (!silent && !pending_answer.empty()) {
      const std::size_t part =
          std::min<std::size_t>({size, most_per_answer, pending_answer.size()});
      Bytes transfer = answer(tag_, pending_answer.substr(0, part), part == pending_answer.size());
      pending_answer.erase(0, part);
      if (spoil) spoil(transfer);
      transfers.push_back(transfer);
    }
    return {};
  }

  Result<std::size_t> bulk_in(std::span<std::uint8_t> out, drivers::Clock::Duration) override {
    if (gone) return *gone;
    if (transfers.empty()) return Error{ErrorCode::kTimeout, "nothing"};
    Bytes& first = transfers.front();
    const std::size_t count = std::min(out.size(), first.size());
    std::copy_n(first.begin(), count, out.begin());
    first.erase(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(count));
    if (first.empty()) transfers.pop_front();
    return count;
  }

  Result<std::size_t> control_in(std::uint8_t request, std::uint16_t value, Recipient,
                                 std::span<std::uint8_t> out, drivers::Clock::Duration) override {
    using namespace drivers::usbtmc;  // NOLINT(google-build-using-namespace)
    if (gone) return *gone;
    requests.push_back(request);
    if (stalls_controls) return Error{ErrorCode::kProtocol, "stalled"};
    std::fill(out.begin(), out.end(), std::uint8_t{0});
    switch (request) {
      case kInitiateAbortBulkIn:
      case kInitiateAbortBulkOut:
        out[0] = abort_status;
        if (!held.empty()) transfers.push_back(std::exchange(held, {}));
        if (out.size() > 1) out[1] = static_cast<std::uint8_t>(value);
        break;
      case kInitiateClear:
        out[0] = clear_status;
        pending_answer.clear();
        break;
      case kReadStatusByte:
        out[0] = kSuccess;
        out[1] = static_cast<std::uint8_t>(value);
        out[2] = interrupt_endpoint ? 0 : status;
        if (interrupt_endpoint) {
          interrupts.push_back({static_cast<std::uint8_t>(0x80 | value), status});
        }
        break;
      default:
        out[0] = pending > 0 ? kPending : kSuccess;
        if (pending > 0) --pending;
        if (out.size() > 1) out[1] = transfers.empty() ? 0 : 1;
    }
    return out.size();
  }

  Status clear_halt(Recipient) override {
    ++halts_cleared;
    return gone ? Status(*gone) : Status{};
  }
  bool has_interrupt_in() const override { return interrupt_endpoint; }
  Result<std::size_t> interrupt_in(std::span<std::uint8_t> out, drivers::Clock::Duration) override {
    if (interrupts.empty()) return Error{ErrorCode::kTimeout, "no notice"};
    const Bytes first = interrupts.front();
    interrupts.pop_front();
    std::copy_n(first.begin(), std::min(out.size(), first.size()), out.begin());
    return std::min(out.size(), first.size());
  }
  std::size_t packet_bytes() const override { return 64; }

 private:
  std::uint8_t tag_ = 0;
};

}  // namespace fogbench::support
