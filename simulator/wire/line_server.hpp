#pragma once
// An auxiliary sensor's lines on a pseudo-terminal, as they come; while nobody has the line open
// they are lost.

#include "simulator/line_far_end.hpp"
#include "simulator/wire/event_loop.hpp"
#include "simulator/wire/pseudo_terminal.hpp"

namespace fogbench::simulator {

class LineServer final : public Server {
 public:
  /// `far_end` and `clock` must outlive the server. Lines are looked for every `every` of bench
  /// time.
  LineServer(PseudoTerminal terminal, LineFarEnd& far_end, const drivers::Clock& clock,
             drivers::Clock::Duration every)
      : terminal_(std::move(terminal)), far_end_(far_end), clock_(clock), every_(every) {}

  void enlist(drivers::PollSet& set) const override;
  void serve(const drivers::PollSet& happened) override;

 private:
  PseudoTerminal terminal_;
  LineFarEnd& far_end_;
  const drivers::Clock& clock_;
  const drivers::Clock::Duration every_;
  Bytes output_;
};

}  // namespace fogbench::simulator
