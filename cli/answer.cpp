#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/command.hpp"
#include "cli/control_client.hpp"
#include "cli/output.hpp"

namespace fogbench::cli {
namespace {

struct AnswerOptions {
  std::string socket, answer;
  std::optional<std::uint64_t> prompt;
  bool json = false;
};

Result<ExitStatus> run_answer(const AnswerOptions& options) {
  auto client = ControlClient::connect(options.socket);
  if (!client) return client.error();
  const auto status = (*client)->call("status");
  if (!status) return status.error();
  const nlohmann::json question = status->value("prompt", nlohmann::json());
  if (!question.is_object()) {
    return Error{ErrorCode::kDevice, "no prompt waits for an answer"};
  }
  const std::uint64_t prompt = options.prompt.value_or(question.value("prompt", std::uint64_t{0}));
  const auto answered =
      (*client)->call("answer", {{"prompt", prompt}, {"confirm", options.answer == "yes"}});
  if (!answered) return answered.error();
  const std::string text = question.value("text", "");
  if (options.json) {
    print_json({{"prompt", prompt}, {"text", text}, {"answer", options.answer}});
  } else {
    fmt::print("Answered {}: {}\n", options.answer, text);
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_answer(CLI::App& app, Action& action) {
  add_command<AnswerOptions>(
      app, action, "answer", "Answer the prompt that the daemon's run waits for",
      "  fogbench answer yes\n"
      "  fogbench answer no            declines: the run is aborted\n"
      "  fogbench answer yes --prompt 3    only if that one still waits",
      [](CLI::App& command, AnswerOptions& options) {
        command.add_option("ANSWER", options.answer, "yes or no")
            ->required()
            ->check(CLI::IsMember({"yes", "no"}));
        command.add_option("--prompt", options.prompt,
                           "The prompt's number (default: the one that waits)");
        command.add_flag("--json", options.json, "One JSON document on stdout");
        add_socket_option(command, options.socket);
      },
      run_answer);
}

}  // namespace fogbench::cli
