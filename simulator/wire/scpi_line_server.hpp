#pragma once
// A SCPI instrument on a serial line, the turntable: one message a line, an answer a line.

#include <string>

#include "simulator/scpi_far_end.hpp"
#include "simulator/wire/deferring_clock.hpp"
#include "simulator/wire/event_loop.hpp"
#include "simulator/wire/pseudo_terminal.hpp"

namespace fogbench::simulator {

class ScpiLineServer final : public Server {
 public:
  /// `far_end` and the clock that it sleeps on must outlive the server.
  ScpiLineServer(PseudoTerminal terminal, ScpiFarEnd& far_end, DeferringClock& clock)
      : terminal_(std::move(terminal)), far_end_(far_end), clock_(clock) {}

  void enlist(drivers::PollSet& set) const override;
  void serve(const drivers::PollSet& happened) override;

 private:
  /// The next whole line, executed; false when there is none or the instrument is busy.
  bool take_line();
  void forget();

  PseudoTerminal terminal_;
  ScpiFarEnd& far_end_;
  DeferringClock& clock_;
  Bytes input_;
  std::string answer_;
  drivers::Clock::Instant ready_at_{};  ///< when the answer goes out and the next line is taken
};

}  // namespace fogbench::simulator
