#pragma once
// Where a test asks what is true of the far ends, and breaks them. A request is a packet of words,
// its answer one packet:
//
//   state                    {"time_s", "coil_horizontal": {"current_a", "zeros", "zero_at_s",
//                            "asked_at_s"}, "coil_vertical": ..., "heater_w", "heats"}
//   energise                 3 A and -2 A, outputs on, the heaters boost
//   break DEVICE KIND        from now on; KIND: absent, silent, garbling, nan
//   mend DEVICE KIND
//
// The answer to the last three, and to what is no request, is one word: done, what.

#include <list>
#include <map>
#include <string>

#include "config/bench.hpp"
#include "drivers/clock.hpp"
#include "simulator/far_ends.hpp"
#include "tests/system/far_bench/packet_listener.hpp"

namespace fogbench::far_bench {

class ControlServer final : public simulator::Server {
 public:
  /// All must outlive the server, which listens to what the supplies hear.
  ControlServer(PacketListener listener, const config::BenchConfig& config,
                simulator::FarEnds& ends, const drivers::Clock& clock);

  void enlist(drivers::PollSet& set) const override;
  void serve(const drivers::PollSet& happened) override;

 private:
  /// What a supply was told, and when, in seconds since the far ends' power-on.
  struct Heard {
    int zeros = 0;
    double zero_at_s = -1.0;
    double asked_at_s = -1.0;
  };
  std::string answer(const std::string& request);
  std::string state();
  void energise();

  PacketListener listener_;
  const config::BenchConfig& config_;
  simulator::FarEnds& ends_;
  const drivers::Clock& clock_;
  std::map<std::string, Heard> heard_;
  std::list<drivers::FileDescriptor> clients_;
};

}  // namespace fogbench::far_bench
