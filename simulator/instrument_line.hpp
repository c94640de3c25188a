#pragma once
// The line to a request-and-answer instrument: what a transaction costs in time, and the faults
// that are the line's rather than the instrument's.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "simulator/fault_schedule.hpp"
#include "simulator/plant.hpp"
#include "simulator/random.hpp"

namespace fogbench::simulator {

class InstrumentLine {
 public:
  /// A late answer comes `late_by` after the request's deadline; with 0 nobody is there any more
  /// to hear it.
  InstrumentLine(std::shared_ptr<Plant> plant, drivers::Clock& clock, FaultSchedule faults,
                 std::uint64_t seed, drivers::Clock::Duration late_by = {})
      : plant_(std::move(plant)),
        clock_(clock),
        late_by_(late_by),
        faults_(std::move(faults)),
        random_(seed) {}

  /// The instrument's next operation, one of config::operations_of: what the faults of the calls
  /// below are looked up for.
  void begin(std::string_view operation) { faults_.begin(operation); }
  /// The request travels for `takes` (twenty times as long while slow, but not past `timeout`).
  /// On success the instrument executes it, on the plant of that moment. kUnplugged while
  /// unplugged, kTimeout after `timeout` while the instrument hears nothing.
  Status request(drivers::Clock::Duration takes, drivers::Clock::Duration timeout);
  /// The answer travels back: kTimeout at the request's deadline while answers are lost, or late
  /// and awaited by nobody; kProtocol while they arrive broken.
  Status answer();
  /// kTimeout, at the deadline of the last request.
  Error wait_in_vain();

  /// False while its plug is out, whoever asks; not for one that an operation pulls.
  bool plugged() const { return !faults_.unplugged(plant_->now_s()); }
  bool fault(FaultKind kind) const { return faults_.active(kind, plant_->now_s()); }
  void set_fault(FaultKind kind, bool on) { faults_.set(kind, on); }
  Plant& plant() { return *plant_; }
  const Plant& plant() const { return *plant_; }
  drivers::Clock& clock() { return clock_; }
  RandomEngine& random() { return random_; }

 private:
  std::shared_ptr<Plant> plant_;  // Shared: the last far end to go takes the plant with it.
  drivers::Clock& clock_;
  drivers::Clock::Duration late_by_;
  drivers::Clock::Instant deadline_{};
  FaultSchedule faults_;
  RandomEngine random_;  ///< of garbage only
};

}  // namespace fogbench::simulator
