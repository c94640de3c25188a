#pragma once
// A gyro that streams frames over a serial line.

#include <memory>
#include <string>

#include "config/bench.hpp"
#include "drivers/frame_parser.hpp"
#include "drivers/frame_rate_meter.hpp"
#include "drivers/instruments.hpp"
#include "drivers/transport.hpp"

namespace fogbench::drivers {

class SerialGyro final : public Gyro {
 public:
  /// `name` stands in front of every message; `clock` must outlive the gyro. Errors: kBadInput for
  /// a layout that cannot be.
  static Result<std::unique_ptr<SerialGyro>> attach(std::string name,
                                                    const config::GyroConfig& config,
                                                    std::unique_ptr<SerialTransport> transport,
                                                    Clock& clock);

  /// Throws away what the line has kept from before, then waits for a first good frame, whose
  /// arrival ties index to clock. Errors: kTimeout, kProtocol, the transport's.
  Status begin() override;
  Status begin_anew(Clock::Instant switched_on) override;
  Result<std::string> identity() override { return identity_; }
  /// Silent for longer than a second and ten frame periods: kTimeout when no byte came, kProtocol
  /// when bytes came but no good frame was among them (wrong baud rate, wrong layout). Good frames
  /// are appended even when an error is returned. Where frames seem to be lost that may only be
  /// late, it waits for them, half a second unless the machine is busy.
  Status read(GyroBlock& out) override;
  const StreamStatistics& statistics() const override { return statistics_; }
  Clock::Instant time_of(std::int64_t index) const override;
  double frame_rate_hz() const override { return frame_rate_hz_; }
  std::optional<FrameRate> measured_frame_rate() const override { return meter_.rate(); }

 private:
  SerialGyro(std::string name, const config::GyroConfig& config,
             std::unique_ptr<SerialTransport> transport, Clock& clock);
  /// Parses what has arrived; whether the line was found empty.
  Result<bool> take(GyroBlock& out);

  std::string name_;
  config::FrameDevice device_;
  std::string identity_;
  double frame_rate_hz_;
  double bytes_per_s_;
  Clock::Duration longest_silence_;
  std::unique_ptr<SerialTransport> transport_;
  Clock& clock_;
  FrameParser parser_;
  FrameRateMeter meter_;
  StreamStatistics before_;        ///< of the gyros that were on the line before
  StreamStatistics statistics_;    ///< of all
  std::int64_t unheard_ = 0;       ///< frames from power-on to the first that was heard
  Clock::Instant first_sample_{};  ///< middle of the sample with index 0
  Clock::Instant last_read_;
  Clock::Instant last_good_{};  ///< when a good frame was last received
  std::size_t bytes_since_good_ = 0;
};

}  // namespace fogbench::drivers
