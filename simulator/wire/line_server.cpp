#include "simulator/wire/line_server.hpp"

#include <array>

namespace fogbench::simulator {

void LineServer::enlist(drivers::PollSet& set) const {
  terminal_.enlist(set, static_cast<short>(POLLIN | (output_.empty() ? 0 : POLLOUT)));
  const auto now = clock_.now().time_since_epoch();
  set.wake_at(drivers::Clock::Instant(now - now % every_ + every_));
}

void LineServer::serve(const drivers::PollSet& /*happened*/) {
  if (!far_end_.plugged()) return terminal_.unplug();
  if (!terminal_.plug()) return;  // At the next turn, perhaps.
  Bytes commands;
  constexpr std::size_t kMostCommands = 256;
  terminal_.receive(commands, kMostCommands);  // It takes every command and does nothing.
  std::array<std::byte, 256> line;
  const auto count = far_end_.read_some(line);
  if (!count) return terminal_.unplug();
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(line.data());
  output_.insert(output_.end(), bytes, bytes + *count);
  if (!terminal_.in_use()) return output_.clear();
  const auto sent = static_cast<std::ptrdiff_t>(terminal_.send(output_));
  output_.erase(output_.begin(), output_.begin() + sent);
}

}  // namespace fogbench::simulator
