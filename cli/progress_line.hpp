#pragma once
// One line on the terminal that overwrites itself; nothing at all when stderr is no terminal.

#include <string>

#include "drivers/clock.hpp"
#include "procedures/run_engine.hpp"

namespace fogbench::cli {

class ProgressLine {
 public:
  ProgressLine();
  void show(const procedures::Progress& progress);
  /// Before anything else is printed.
  void clear();

 private:
  bool wanted_;
  bool shown_ = false;
  drivers::SteadyClock clock_;  ///< the reader's time, not the bench's
  drivers::Clock::Instant next_{};
};

}  // namespace fogbench::cli
