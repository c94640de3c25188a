#pragma once
// Puts what the operator is asked, and what he answers, into the record of the run under way: the
// moment at which a prompt appeared, and who answered it.

#include <nlohmann/json.hpp>
#include <string>

#include "drivers/instruments.hpp"
#include "procedures/run_engine.hpp"

namespace fogbench::daemon {

class OperatorOnRecord final : public drivers::Operator {
 public:
  /// Must outlive it.
  explicit OperatorOnRecord(drivers::Operator& person) : person_(person) {}
  /// The engine whose run is meant; it must outlive the last question.
  void attach(procedures::RunEngine& engine) { engine_ = &engine; }

  bool can_resume() const override { return person_.can_resume(); }
  std::string name() const override { return person_.name(); }
  Result<bool> confirm(const std::string& prompt) override {
    if (Status noted = note("asks: " + prompt, {{"asks", prompt}}); !noted) return noted.error();
    auto answer = person_.confirm(prompt);
    const std::string by = person_.name();
    if (!answer || by.empty()) return answer;
    const std::string says = *answer ? "yes" : "no";
    const Status noted = note("answer " + says + " to \"" + prompt + "\", by " + by,
                              {{"action", "answer " + says}, {"user", by}});
    if (!noted) return noted.error();
    return answer;
  }

 private:
  Status note(const std::string& message, const nlohmann::ordered_json& data) {
    if (engine_ == nullptr) return {};
    return engine_->note(
        message, data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  }

  drivers::Operator& person_;
  procedures::RunEngine* engine_ = nullptr;
};

}  // namespace fogbench::daemon
