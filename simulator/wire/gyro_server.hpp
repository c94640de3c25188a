#pragma once
// The gyro's frames on a pseudo-terminal, at their rate. Frames are made when they can go out, so a
// host that is slow to read loses none of the last ten minutes; while nobody has the line open they
// are lost, as on a real one.

#include "simulator/gyro_far_end.hpp"
#include "simulator/wire/deferring_clock.hpp"
#include "simulator/wire/event_loop.hpp"
#include "simulator/wire/pseudo_terminal.hpp"

namespace fogbench::simulator {

class GyroServer final : public Server {
 public:
  /// `far_end` and `clock` must outlive the server. Frames are looked for every `every` of bench
  /// time.
  GyroServer(PseudoTerminal terminal, GyroFarEnd& far_end, const config::FrameDevice& device,
             const drivers::Clock& clock, drivers::Clock::Duration every)
      : terminal_(std::move(terminal)),
        far_end_(far_end),
        clock_(clock),
        every_(every),
        buffer_(kFramesAtOnce * device.frame_bytes) {}

  void enlist(drivers::PollSet& set) const override;
  void serve(const drivers::PollSet& happened) override;

 private:
  static constexpr std::size_t kFramesAtOnce = 64;

  /// The next whole frames; false when there is none now.
  bool make_frames();

  PseudoTerminal terminal_;
  GyroFarEnd& far_end_;
  const drivers::Clock& clock_;
  const drivers::Clock::Duration every_;
  Bytes buffer_;  ///< frames on their way out
  std::size_t begin_ = 0, end_ = 0;
};

}  // namespace fogbench::simulator
