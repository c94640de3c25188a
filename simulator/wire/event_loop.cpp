#include "simulator/wire/event_loop.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>

namespace fogbench::simulator {
namespace {

using drivers::Clock;

/// A plug is found pulled at the latest after this time of the machine's, whoever is idle.
constexpr std::chrono::milliseconds kLongestTurn{20};

std::chrono::nanoseconds machine_time(Clock::Duration bench, double speed) {
  const double wanted_ns = static_cast<double>(bench.count()) / speed;
  const double most_ns = std::chrono::duration<double, std::nano>(kLongestTurn).count();
  return std::chrono::nanoseconds{std::llround(std::clamp(wanted_ns, 0.0, most_ns))};
}

}  // namespace

Status run_event_loop(const std::vector<std::unique_ptr<Server>>& servers, const Clock& clock,
                      double speed, int stop) {
  for (;;) {
    drivers::PollSet set;
    set.add(stop, POLLIN);
    for (const auto& server : servers) server->enlist(set);
    const Clock::Instant now = clock.now();
    if (!set.wait(machine_time(std::max(set.wake_at(), now) - now, speed))) {
      return Error{ErrorCode::kDevice, std::string("waiting failed: ") + std::strerror(errno)};
    }
    if (set.happened(stop) != 0) return {};
    for (const auto& server : servers) server->serve(set);
  }
}

}  // namespace fogbench::simulator
