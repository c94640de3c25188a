// fogbench help: a command's help, or how a formula of one's own is written.

#include <fmt/format.h>

#include "cli/command.hpp"
#include "config/nearest_name.hpp"
#include "model/effects/expression.hpp"

namespace fogbench::cli {
namespace {

constexpr auto kExpressions = "expressions";

/// `{}`: the functions.
constexpr auto kExpressionText =
    R"text(A term that the catalogue lacks is written as a formula over the table's columns, in a model file:

  {{"name": "mine", "terms": [
    {{"effect": "bias"}},
    {{"effect": "my_saturation", "expression": "tanh(field_z_ut / s)", "unit": "deg/h",
     "parameters": {{"s": 150}}}}
  ]}}

The fit finds the term's coefficient, here in deg/h, and its inner parameters, here s; what stands
in "parameters" is where the search for them starts: the right power of ten is enough. The name is
your own and must not be one of the catalogue's. Expressions of one model may share a parameter; it
stands in each of them.

  names       columns of the table (fogbench export and a CSV file's header show them) and the
              signals made of them (last column of fogbench effects); inner parameters; pi, e
  operators   + - * / ^  ( )  < <= > >= == != && ||  condition ? value : otherwise
              x^2^3 is x^(2^3), and -x^2 is -(x^2); true is 1, false 0
  functions   {}
              log is natural, as ln is; atan2(y, x); min, max, sum and avg take any number of values

Then as with any model:

  fogbench fit 7 --model mine.json -o fitted.json
  fogbench diagnose 7 --model magnetic --candidate mine.json    # beside the catalogue
)text";

/// The functions' names, as lines of the text.
std::string functions_text() {
  constexpr std::size_t kWidth = 86;
  std::string text, line;
  for (const std::string& name : model::expression_functions()) {
    if (line.size() + name.size() > kWidth) {
      text += line + "\n              ";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + name;
  }
  return text + line;
}

Result<ExitStatus> help_on(const CLI::App& app, const std::vector<std::string>& topic) {
  if (topic.empty()) {
    fmt::print("{}", app.help());
    return ExitStatus::kDone;
  }
  if (topic.front() == kExpressions) {
    fmt::print(kExpressionText, functions_text());
    return ExitStatus::kDone;
  }
  const CLI::App* command = &app;
  std::string above;
  for (const std::string& word : topic) {
    std::vector<std::string> names;
    const CLI::App* below = nullptr;
    for (const CLI::App* one : command->get_subcommands([](const CLI::App*) { return true; })) {
      names.push_back(one->get_name());
      if (one->get_name() == word) below = one;
    }
    names.emplace_back(kExpressions);
    if (below == nullptr) {
      return Error{ErrorCode::kUsage,
                   fmt::format("there is no help on {}{}", word,
                               config::did_you_mean(word, {names.begin(), names.end()}))};
    }
    above += command->get_name() + " ";
    command = below;
  }
  fmt::print("{}", command->help(above + command->get_name()));
  return ExitStatus::kDone;
}

}  // namespace

void add_help(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("help", "Show a command's help, or how a formula is written");
  const auto topic = std::make_shared<std::vector<std::string>>();
  command->add_option("TOPIC", *topic, "A command, or `expressions`");
  command->footer("Examples:\n  fogbench help fit\n  fogbench help expressions\n");
  command->callback(
      [&app, &action, topic] { action = [&app, topic] { return help_on(app, *topic); }; });
}

}  // namespace fogbench::cli
