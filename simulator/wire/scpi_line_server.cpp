#include "simulator/wire/scpi_line_server.hpp"

#include <algorithm>
#include <chrono>

namespace fogbench::simulator {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kLongestLine = 4096;
/// What the far end takes for the host's patience.
constexpr drivers::Clock::Duration kLinePatience = 1s;

}  // namespace

void ScpiLineServer::enlist(drivers::PollSet& set) const {
  terminal_.enlist(set, POLLIN);
  if (!answer_.empty() || !input_.empty()) {
    if (clock_.now() < ready_at_) set.wake_at(ready_at_);
  }
}

void ScpiLineServer::forget() {
  input_.clear();
  answer_.clear();
}

void ScpiLineServer::serve(const drivers::PollSet&) {
  if (!far_end_.plugged()) {
    forget();
    return terminal_.unplug();
  }
  if (!terminal_.plug()) return;  // At the next turn, perhaps.
  // Nobody need wait for an answer: what was sent is executed all the same.
  const bool heard = terminal_.in_use(&input_, kLongestLine);
  if (heard) terminal_.receive(input_, kLongestLine);
  do {
    if (!heard) answer_.clear();
  } while (take_line());
  if (!heard && std::find(input_.begin(), input_.end(), '\n') == input_.end()) forget();
}

bool ScpiLineServer::take_line() {
  if (clock_.now() < ready_at_) return false;
  if (!answer_.empty()) {
    terminal_.send(ByteView(reinterpret_cast<const std::uint8_t*>(answer_.data()), answer_.size()));
    answer_.clear();
  }
  const auto end = std::find(input_.begin(), input_.end(), '\n');
  if (end == input_.end()) {
    if (input_.size() >= kLongestLine) input_.clear();  // No message is as long.
    return false;
  }
  const std::string line(input_.begin(), end);
  input_.erase(input_.begin(), end + 1);
  const Status taken = far_end_.write(line);
  ready_at_ = clock_.take_due();
  if (!taken && taken.error().code == ErrorCode::kUnplugged) {  // This line pulled the plug.
    forget();
    terminal_.unplug();
    return false;
  }
  constexpr std::uint8_t kMessageAvailable = 0x10;
  const Result<std::uint8_t> status = far_end_.read_status_byte();
  if (!taken || !status || (*status & kMessageAvailable) == 0) return true;
  if (Result<std::string> text = far_end_.read(kLinePatience)) answer_ = *std::move(text) + "\n";
  ready_at_ += clock_.take_due() - clock_.now();
  return true;
}

}  // namespace fogbench::simulator
