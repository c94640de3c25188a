#pragma once
// The magnetometer's reports on a local socket, a packet each: what the stand-in for libhidapi
// (hid_stand_in.cpp) takes for the kernel's hidraw. While it is unplugged there is no socket.

#include <filesystem>
#include <list>
#include <optional>

#include "config/device.hpp"
#include "simulator/hid_far_end.hpp"
#include "simulator/wire/bytes.hpp"
#include "simulator/wire/deferring_clock.hpp"
#include "tests/system/far_bench/packet_listener.hpp"

namespace fogbench::far_bench {

class HidServer final : public simulator::Server {
 public:
  /// `far_end` and the clock that it sleeps on must outlive the server.
  HidServer(std::filesystem::path path, const config::HidDevice& device,
            simulator::HidFarEnd& far_end, simulator::DeferringClock& clock)
      : path_(std::move(path)),
        period_(drivers::from_seconds(device.report_period.count())),
        far_end_(far_end),
        clock_(clock),
        report_(device.report_bytes) {}

  void enlist(simulator::PollSet& set) const override;
  void serve(const simulator::PollSet& happened) override;

 private:
  const std::filesystem::path path_;
  const drivers::Clock::Duration period_;
  simulator::HidFarEnd& far_end_;
  simulator::DeferringClock& clock_;
  simulator::Bytes report_;
  drivers::Clock::Instant next_{};
  std::optional<PacketListener> listener_;
  std::list<simulator::FileDescriptor> hosts_;
};

}  // namespace fogbench::far_bench
