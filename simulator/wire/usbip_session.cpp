#include "simulator/wire/usbip_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bitset>

namespace fogbench::simulator {

using State = UsbTransfer::State;

namespace {

/// The kernel's drivers have a handful under way; libusb some tens.
constexpr std::size_t kMostPending = 256;
constexpr std::size_t kMostPendingBytes = 1024 * 1024;

}  // namespace

Status UsbipSession::take(const UsbipCommand& command, ByteView data) {
  if (command.unlink) {
    append(unlinked_, unlink(command));
    return {};
  }
  std::size_t bytes = data.size();
  for (const Pending& pending : pending_) bytes += pending.data.size();
  if (pending_.size() >= kMostPending || bytes > kMostPendingBytes) {
    return Error{ErrorCode::kProtocol,
                 fmt::format("{} transfers of {} bytes at once, expected at most {} of {}",
                             pending_.size() + 1, bytes, kMostPending, kMostPendingBytes)};
  }
  pending_.push_back({command, Bytes(data.begin(), data.end())});
  return {};
}

Bytes UsbipSession::unlink(const UsbipCommand& command) {
  const auto found = std::find_if(pending_.begin(), pending_.end(), [&](const Pending& pending) {
    return pending.command.sequence == command.unlinked;
  });
  if (found == pending_.end()) return encode_unlinked(command.sequence, 0);  // It has ended.
  pending_.erase(found);
  return encode_unlinked(command.sequence, kUsbUnlinked);
}

UsbTransfer UsbipSession::go_on(const Pending& pending) {
  const UsbipCommand& command = pending.command;
  if (command.endpoint == 0) return device_.control(command.setup, pending.data);
  return command.in ? device_.in(command.endpoint, command.length)
                    : device_.out(command.endpoint, pending.data);
}

Status UsbipSession::advance(Bytes& out) {
  append(out, unlinked_);
  unlinked_.clear();
  next_ = drivers::Clock::Instant::max();
  std::bitset<32> blocked;  // endpoints, either direction, whose earlier transfer goes on
  for (auto pending = pending_.begin(); pending != pending_.end();) {
    const UsbipCommand& command = pending->command;
    const std::size_t pipe = 2U * command.endpoint + (command.in ? 1U : 0U);
    UsbTransfer transfer = UsbTransfer::in_state(State::kBusy);
    if (!pending->silent && !blocked[pipe]) transfer = go_on(*pending);
    if (transfer.state == State::kGone) {
      return Error{ErrorCode::kDevice, "unplugged"};
    }
    if (transfer.state == State::kBusy || transfer.state == State::kSilent) {
      pending->silent = pending->silent || transfer.state == State::kSilent;
      blocked.set(pipe);
      next_ = std::min(next_, transfer.until);
      ++pending;
      continue;
    }
    if (transfer.data.size() > command.length) transfer.data.resize(command.length);
    const bool done = transfer.state == State::kDone;
    const std::size_t actual = command.in ? transfer.data.size() : pending->data.size();
    append(out, encode_submitted(command, done ? 0 : kUsbStall,
                                 static_cast<std::uint32_t>(done ? actual : 0),
                                 done ? ByteView(transfer.data) : ByteView()));
    pending = pending_.erase(pending);
  }
  return {};
}

}  // namespace fogbench::simulator
