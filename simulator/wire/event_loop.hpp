#pragma once
// One thread serves every instrument. Before each turn every server says what it waits for
// (descriptors and an instant); after it, each looks what has come.

#include <memory>
#include <vector>

#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/poll_set.hpp"

namespace fogbench::simulator {

class Server {
 public:
  Server() = default;
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  virtual ~Server() = default;
  virtual void enlist(drivers::PollSet& set) const = 0;
  /// Never blocks.
  virtual void serve(const drivers::PollSet& happened) = 0;
};

/// Runs until `stop` is readable. `speed`: bench seconds of the clock in one of the machine's.
/// kDevice when the machine cannot wait any more.
Status run_event_loop(const std::vector<std::unique_ptr<Server>>& servers,
                      const drivers::Clock& clock, double speed, int stop);

}  // namespace fogbench::simulator
