#pragma once
// Which gyro is on the line, and since when it operates. A gyro that is switched off is silent, and
// nothing else tells: so the line is listened to between runs. Each time that it was silent counts
// as switched off, unless somebody says since when the gyro is on. On the bench's thread.

#include <optional>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "drivers/clock.hpp"
#include "drivers/instruments.hpp"

namespace fogbench::daemon {

/// Since when a gyro operates, and who says so.
struct SwitchedOn {
  double unix_s = 0.0;
  std::string by;
};

class GyroOnLine {
 public:
  /// Shorter ones are a busy machine, or a slow gyro.
  static constexpr std::chrono::seconds kSilence{3};
  static constexpr double kSilencePeriods = 10.0;

  /// All must outlive it; the gyro has begun.
  GyroOnLine(drivers::Gyro& gyro, drivers::Clock& clock)
      : gyro_(gyro), clock_(clock), heard_(clock.now()) {}

  /// Takes what has come. A sentence when the line has fallen silent, or is heard again.
  std::string listen();
  /// After a run, which has read the line itself.
  void heard() {
    heard_ = clock_.now();
    silent_ = false;
  }

  struct Taken {
    std::vector<std::string> remarks;  ///< for the run's record
    bool doubtful = false;  ///< another gyro is wanted, and the line has not been silent since
    std::string before;     ///< the gyro that was measured last; empty: unknown
  };
  /// For a run of the gyro with this serial number, which may be empty. Where it is another one, or
  /// was switched off, its frames and times are counted anew. `exchanged`: it has just been put on
  /// and switched on. Errors: the gyro's.
  Result<Taken> take(const std::string& gyro, const std::optional<SwitchedOn>& said,
                     bool exchanged);
  /// The gyro that was measured last; empty: unknown.
  const std::string& gyro() const { return serial_number_; }

 private:
  std::string at(drivers::Clock::Instant instant) const;

  drivers::Gyro& gyro_;
  drivers::Clock& clock_;
  std::string serial_number_;
  drivers::Clock::Instant heard_;
  bool silent_ = false;
  /// The last silence since the last run: when the line was heard again, and how long it lasted.
  struct Silence {
    drivers::Clock::Instant ended{};
    double lasted_s = 0.0;
  };
  std::optional<Silence> silence_;
  drivers::GyroBlock frames_;
};

}  // namespace fogbench::daemon
