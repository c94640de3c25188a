#pragma once
// Runs a real program, with a deadline, and keeps what it printed.

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace fogbench::support {

struct Finished {
  int status = -1;  ///< exit status; -1 when a signal ended it
  int signal = 0;
  std::string out, err;
};

class Process {
 public:
  struct Setup {
    std::vector<std::string> environment;  ///< "NAME=value", added to the test's own
    std::function<void()> in_child;        ///< before the program starts: limits, user
  };
  Process(const std::vector<std::string>& command, const Setup& setup = {});
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  /// Kills what is still running.
  ~Process();

  void signal(int number) const;
  pid_t id() const { return pid_; }
  /// Waits until standard output holds `text`; false when the program ended or time ran out.
  bool wait_for_output(const std::string& text, std::chrono::seconds timeout);
  /// What it has printed by then.
  const std::string& output() const { return finished_.out; }
  /// Waits for the end; a program that outlives the timeout is killed.
  Finished wait(std::chrono::seconds timeout = std::chrono::seconds(120));

 private:
  void read_some(int timeout_ms);
  pid_t pid_ = -1;
  int out_ = -1, err_ = -1;
  Finished finished_;
};

Finished run(const std::vector<std::string>& command, const Process::Setup& setup = {});

}  // namespace fogbench::support
