#pragma once
// The gyro at its serial line: frames at the frame rate, laid out as the instrument's description
// says, with sequence and check value. Frame i is the mean over its own sample,
//
//   rate = Earth's rate on the axis + effects + noise (bin mean),
//
// quantised, and goes out when the sample ends. The effects are those of the plant's step that the
// middle of the sample lies in. Bytes come into being when they are read, up to the
// clock's present; nothing is stored but the frame that a read stopped in. A line that stalls (late
// and slow answers) keeps its frames and brings them together. Frames older than Plant::kKeptS that
// nobody read are lost, as in a receive buffer that runs over.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "config/device.hpp"
#include "drivers/crc.hpp"
#include "drivers/transport.hpp"
#include "simulator/fault_schedule.hpp"
#include "simulator/noise_generator.hpp"
#include "simulator/plant.hpp"

namespace fogbench::simulator {

class GyroFarEnd final : public drivers::SerialTransport {
 public:
  static constexpr std::initializer_list<FaultKind> kFaults = {
      FaultKind::kTimeout, FaultKind::kLateAnswer, FaultKind::kBadChecksum, FaultKind::kBadSequence,
      FaultKind::kGarbage, FaultKind::kNan,        FaultKind::kStuck,       FaultKind::kException,
      FaultKind::kUnplug,  FaultKind::kSlowAnswer};

  GyroFarEnd(const config::FrameDevice& device, const config::NoiseCoefficients& noise,
             std::shared_ptr<Plant> plant, FaultSchedule faults, std::uint64_t seed);

  Result<std::size_t> read_some(std::span<std::byte> out) override;
  /// Another gyro of the same kind, switched on now: what the one before went through is not its
  /// past, and its counter begins anew.
  void exchange();
  /// Takes every command and does nothing.
  Status write(std::span<const std::byte> bytes) override;
  bool plugged() const { return !faults_.unplugged(plant_->now_s()); }
  void set_fault(FaultKind kind, bool on) { faults_.set(kind, on); }

 private:
  /// Frames complete by now.
  std::int64_t complete_frames() const;
  /// Draws frame next_ and writes it to `out`.
  void make_frame(std::uint8_t* out);
  std::uint32_t next_sequence() const;
  /// In the status, or where there is none by a rate that is no number.
  void say_invalid(std::uint8_t* frame) const;
  /// False when a fault keeps the frame off the line.
  bool spoil(std::uint8_t* frame, double time_s);
  /// Puts every frame up to `complete` into pending_, faults and all.
  void make_with_faults(std::int64_t complete);
  void enter_step(std::int64_t step);
  void skip_lost();

  const config::FrameDevice device_;
  const std::size_t frame_bytes_;
  const double frame_s_;
  std::shared_ptr<Plant> plant_;  // Shared with the other far ends.
  FaultSchedule faults_;
  NoiseGenerator noise_;
  AngleQuantiser quantiser_;
  drivers::Crc crc_;
  RandomEngine garbage_;
  std::vector<std::uint8_t> template_;  ///< header, status and the constant fields
  std::int64_t next_ = 0;               ///< the frame to be made
  std::uint32_t sequence_ = 0;
  double step_rate_deg_per_h_ = 0.0;
  std::int64_t step_end_ = 0;  ///< first frame beyond the present step
  /// A frame that a read stopped in; with faults, all that has not been read.
  std::vector<std::uint8_t> pending_;
  std::size_t pending_sent_ = 0;
  std::size_t pending_arrived_ = 0;  ///< the rest is held back
  std::optional<double> held_back_since_s_;
  std::vector<std::uint8_t> last_rate_;      ///< as it last went out, for a stuck gyro
  std::vector<std::uint8_t> last_sequence_;  ///< likewise, for one that repeats
};

}  // namespace fogbench::simulator
