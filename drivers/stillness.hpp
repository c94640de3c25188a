#pragma once
// Notices measured values that stand still to the last bit. Those of a living sensor move, if only
// by its noise; those of a converter that hangs, or of a controller that has lost its sensor card,
// come again and again and look fresh.

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "config/units.hpp"
#include "drivers/clock.hpp"

namespace fogbench::drivers {

class StillnessWatch {
 public:
  /// Without `longest` anything may stand still: the resolution is coarser than the noise.
  explicit StillnessWatch(std::optional<config::Seconds> longest) : longest_(longest) {}

  /// Takes one reading. How long all its values have stood still, when that is longer than they
  /// may; two equal readings are not enough, however far apart.
  std::optional<config::Seconds> add(std::span<const double> values, Clock::Instant taken_at) {
    if (!std::equal(values.begin(), values.end(), last_.begin(), last_.end())) {
      last_.assign(values.begin(), values.end());
      since_ = taken_at;
      repeats_ = 0;
      return std::nullopt;
    }
    ++repeats_;
    const config::Seconds still{to_seconds(taken_at - since_)};
    if (!longest_ || repeats_ < kFewest || still < *longest_) return std::nullopt;
    return still;
  }

 private:
  static constexpr std::size_t kFewest = 2;
  std::optional<config::Seconds> longest_;
  std::vector<double> last_;
  Clock::Instant since_{};
  std::size_t repeats_ = 0;
};

}  // namespace fogbench::drivers
