#pragma once
// The person at a real bench, asked on the terminal that the daemon runs in.

#include <cstdio>
#include <functional>
#include <string>

#include "drivers/instruments.hpp"

namespace fogbench::daemon {

class TerminalOperator final : public drivers::Operator {
 public:
  /// Reads answers from `in` and writes prompts to `out`; `aborted` ends the waiting. All must
  /// outlive it.
  TerminalOperator(int in, std::FILE* out, std::function<bool()> aborted)
      : in_(in), out_(out), aborted_(std::move(aborted)) {}

  /// Asks until the answer is yes or no. An abort is a no; kDevice when nobody can answer.
  Result<bool> confirm(const std::string& prompt) override;
  std::string name() const override;

 private:
  Result<std::string> read_line(const std::string& prompt);

  int in_;
  std::FILE* out_;
  std::function<bool()> aborted_;
};

}  // namespace fogbench::daemon
