#pragma once
// Asks whoever answers first over the control socket. On the bench's thread.

#include <optional>
#include <string>

#include "daemon/run_desk.hpp"
#include "drivers/instruments.hpp"

namespace fogbench::daemon {

class DeskOperator final : public drivers::Operator {
 public:
  /// The desk must outlive it.
  explicit DeskOperator(RunDesk& desk) : desk_(desk) {}
  /// Before the first run; the engine must outlive the last.
  void attach(procedures::RunEngine& engine) { engine_ = &engine; }

  bool can_resume() const override { return true; }
  Result<bool> confirm(const std::string& prompt) override {
    if (engine_ == nullptr) return Error{ErrorCode::kDevice, "nobody can be asked yet: " + prompt};
    const std::uint64_t asked = desk_.ask(prompt);
    std::optional<bool> answer;
    Status watched;
    while (watched && !answer) {
      watched = engine_->keep_watch();
      answer = desk_.answer_to(asked);
    }
    desk_.withdraw();
    if (!watched) return watched.error();
    return *answer;
  }

 private:
  RunDesk& desk_;
  procedures::RunEngine* engine_ = nullptr;
};

}  // namespace fogbench::daemon
