#pragma once
// Runs that nobody ended, found when the daemon started: each is offered until somebody takes it up
// or gives it up.

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fogbench::daemon {

struct InterruptedRun {
  std::int64_t run = 0;
  std::string procedure;
  std::string by;
  std::string started_at;
  std::int64_t points = 0;
  std::string gyro;
  std::string obstacle;  ///< why it cannot be taken up; empty: it can
};

class OfferedRuns {
 public:
  /// Oldest first.
  void add(InterruptedRun run) { runs_.push_back(std::move(run)); }
  void withdraw(std::int64_t run) {
    std::erase_if(runs_, [run](const InterruptedRun& offered) { return offered.run == run; });
  }
  bool has(std::int64_t run) const {
    return std::any_of(runs_.begin(), runs_.end(),
                       [run](const InterruptedRun& offered) { return offered.run == run; });
  }
  /// The one that is offered now.
  std::optional<InterruptedRun> last() const {
    return runs_.empty() ? std::nullopt : std::optional(runs_.back());
  }

 private:
  std::vector<InterruptedRun> runs_;
};

}  // namespace fogbench::daemon
