#pragma once
// A simulated bench whose far ends outlive whoever speaks to them: a daemon that dies is a session
// that is dropped, and what it energised stays so. Faults begin when a test says so, and what is
// true is asked of the plant, never of a driver.

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/bench.hpp"
#include "drivers/clock.hpp"
#include "drivers/open_bench.hpp"
#include "simulator/far_ends.hpp"

namespace fogbench::system_test {

/// A virtual clock on which something may happen at an instant, whoever sleeps past it.
class EventClock final : public drivers::Clock {
 public:
  Instant now() const override { return clock_.now(); }
  WallTime wall_now() const override { return clock_.wall_now(); }
  void sleep_until(Instant deadline) override;
  void in(Duration time, std::function<void()> happens) {
    events_.emplace(now() + time, std::move(happens));
  }

 private:
  drivers::VirtualClock clock_;
  std::multimap<Instant, std::function<void()>> events_;
};

enum class Ill {
  kAbsent,         ///< the plug is out
  kSilent,         ///< hears nothing
  kStuck,          ///< an actuator that takes every command and obeys none; a sensor that stands
  kGarbling,       ///< obeys, and answers garbage
  kBadChecksum,    ///< obeys, and no answer's check value is right
  kWrongIdentity,  ///< another instrument than described, since the plug was out last
  kNoNumber,       ///< measures not-a-number
  kOpenCircuit,    ///< what it drives is not connected
  kManualMode,     ///< a thermostat that heats by hand, in a mode that nobody described
};

struct Fault {
  std::string_view device;
  Ill ill;
};

/// Each instrument with each fault that it can have.
const std::vector<Fault>& all_faults();
/// "coil_vertical absent"
std::string name_of(const Fault& fault);

class EnduringBench {
 public:
  explicit EnduringBench(const config::BenchConfig& config);

  EventClock& clock() { return clock_; }
  /// The transports of a session; they refer to the far ends here.
  drivers::Transports transports();

  /// Both outputs on with 3 A and -2 A, the heaters boost.
  void energise();
  /// Begins now. `in_use`: somebody has reached the instrument; it takes pulling the plug to put
  /// another one there.
  void begin(const Fault& fault, bool in_use);

  // The truth.
  double current_a(std::string_view coil);
  bool heats();
  /// When the first message of `text` reached a coil supply since what was heard was forgotten;
  /// after all time when none has.
  drivers::Clock::Instant heard(std::string_view coil, std::string_view text) const;
  void forget_what_was_heard() { heard_.clear(); }

  /// What the wire itself adds to the faults of the far ends.
  struct Temper {
    bool disobeys = false;
    bool other_identity = false;
    bool manual = false;
  };

 private:
  const config::BenchConfig config_;
  EventClock clock_;
  simulator::FarEnds ends_;
  std::map<std::string, Temper, std::less<>> temper_;
  std::map<std::pair<std::string, std::string>, drivers::Clock::Instant> heard_;
};

}  // namespace fogbench::system_test
