#include "simulator/wire/gyro_server.hpp"

namespace fogbench::simulator {

void GyroServer::enlist(drivers::PollSet& set) const {
  const bool full = begin_ < end_;
  terminal_.enlist(set, static_cast<short>(POLLIN | (full ? POLLOUT : 0)));
  if (full) return;
  const auto now = clock_.now().time_since_epoch();
  set.wake_at(drivers::Clock::Instant(now - now % every_ + every_));
}

void GyroServer::serve(const drivers::PollSet&) {
  if (!far_end_.plugged()) return terminal_.unplug();
  if (!terminal_.plug()) return;  // At the next turn, perhaps.
  const bool heard = terminal_.in_use();
  Bytes commands;
  constexpr std::size_t kMostCommands = 256;
  terminal_.receive(commands, kMostCommands);  // It takes every command and does nothing.
  if (!heard) {
    begin_ = end_ = 0;
    while (make_frames()) begin_ = end_;
    return;
  }
  do {
    begin_ += terminal_.send(ByteView(buffer_).subspan(begin_, end_ - begin_));
  } while (begin_ == end_ && make_frames());
}

bool GyroServer::make_frames() {
  const Result<std::size_t> count = far_end_.read_some(std::as_writable_bytes(std::span(buffer_)));
  if (!count) terminal_.unplug();  // This frame pulled the plug.
  begin_ = 0;
  end_ = count ? *count : 0;
  return end_ > 0;
}

}  // namespace fogbench::simulator
