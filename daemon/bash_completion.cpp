#include "daemon/bash_completion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <vector>

namespace fogbench::daemon {
namespace {

using Words = std::vector<std::string>;

/// What fills `words` for the value of an option or an argument: the names of the ready files of
/// one kind, or what the program itself knows.
const std::map<std::string, std::string> kFilledBy{{"--bench", "_fogbench_ready benches"},
                                                   {"--candidate", "_fogbench_ready models"},
                                                   {"--limits", "_fogbench_ready limits"},
                                                   {"--model", "_fogbench_ready models"},
                                                   {"--scenario", "_fogbench_ready scenarios"},
                                                   {"DEVICE", "_fogbench_ready devices"},
                                                   {"PROCEDURE", "_fogbench_ready procedures"},
                                                   {"--answer", "_fogbench_ask effects"},
                                                   {"EFFECT", "_fogbench_ask effects"},
                                                   {"TOPIC", "_fogbench_ask topics"},
                                                   {"--quiet", "_fogbench_ask runs"},
                                                   {"DATA", "_fogbench_ask runs"},
                                                   {"RUN", "_fogbench_ask runs"},
                                                   {"--set", "_fogbench_ask parameters"}};

struct Command {
  std::string name;  ///< empty for the program itself, "device probe" for one below another
  Words commands, options;
  std::string filled_by;  ///< for its arguments
};

/// The values of an option with a choice: "{a,b}" in the name of its type.
Words choices(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

/// A command and those below it; what the values of options are is gathered by option.
void gather(const CLI::App& app, const std::string& name, std::vector<Command>& commands,
            std::map<std::string, std::string>& values) {
  Command command{name, {}, {}, {}};
  for (const CLI::Option* option : app.get_options()) {
    const auto filled_by =
        kFilledBy.find(option->get_positional() ? option->get_name(true) : option->get_name());
    if (option->get_positional()) {
      if (filled_by != kFilledBy.end()) command.filled_by = filled_by->second;
      for (const std::string& choice : choices(*option)) command.commands.push_back(choice);
      continue;
    }
    Words names;
    for (const std::string& letter : option->get_snames()) names.push_back("-" + letter);
    for (const std::string& word : option->get_lnames()) names.push_back("--" + word);
    command.options.insert(command.options.end(), names.begin(), names.end());
    if (option->get_items_expected_max() == 0) continue;
    const std::string says = filled_by == kFilledBy.end()
                                 ? fmt::format("words=({})", fmt::join(choices(*option), " "))
                                 : filled_by->second;
    for (const std::string& one : names) values[one] = says;
  }
  for (const CLI::App* below : app.get_subcommands([](const CLI::App*) { return true; })) {
    command.commands.push_back(below->get_name());
  }
  commands.push_back(command);
  for (const CLI::App* below : app.get_subcommands([](const CLI::App*) { return true; })) {
    gather(*below, name.empty() ? below->get_name() : name + " " + below->get_name(), commands,
           values);
  }
}

// Written for bash alone, without the helpers of the package bash-completion. When nothing
// matches, bash itself completes the names of files.
constexpr auto kScript = R"(# bash completion of {program}, printed by: {program} --completion
# The names of the ready files of one kind, found as the program finds them.
_fogbench_ready() {{
  local program folder file
  program=$(type -P "${{COMP_WORDS[0]/#\~/$HOME}}") && program=$(readlink -f "$program")
  for folder in "${{FOGBENCH_CONFIG_DIR:-}}" "${{program%/*}}/../../config" \
    "${{program%/*}}/../share/fogbench/config"; do
    [[ -d $folder/$1 ]] || continue
    for file in "$folder/$1"/*.json; do
      file=${{file##*/}}
      words+=("${{file%.json}}")
    done
    return
  done
}}
# What the program knows of one kind, with the words typed so far.
_fogbench_ask() {{
  local program
  program=$(type -P "${{COMP_WORDS[0]/#\~/$HOME}}") || return
  words+=($("$program" --words "$1" "${{COMP_WORDS[@]:1:COMP_CWORD-1}}" 2> /dev/null))
}}
_{program}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}}
  local command='' next i words=() commands=() options=()
  for ((i = 1; i < COMP_CWORD; ++i)); do
    next=${{command:+$command }}${{COMP_WORDS[i]}}
    case $next in
      {names}) command=$next ;;
    esac
  done
  case $before in
{values}    *)
      case $command in
{commands}      esac
      if [[ $word == -* ]]; then words=("${{options[@]}}"); else words+=("${{commands[@]}}"); fi
      ;;
  esac
  COMPREPLY=()
  for next in "${{words[@]}}"; do
    [[ $next != "$word"* ]] || COMPREPLY+=("$next")
  done
  [[ ${{COMPREPLY[*]}} != *= ]] || compopt -o nospace 2> /dev/null
  return 0
}}
complete -o default -F _{program} {program}
)";

}  // namespace

std::string bash_completion(const CLI::App& app) {
  std::vector<Command> commands;
  std::map<std::string, std::string> values;
  gather(app, "", commands, values);
  Words names;
  std::string of_commands, of_values;
  for (const Command& command : commands) {
    if (!command.name.empty()) names.push_back("'" + command.name + "'");
    of_commands += fmt::format("        '{}')\n          commands=({})\n          options=({})\n",
                               command.name, fmt::join(command.commands, " "),
                               fmt::join(command.options, " "));
    if (!command.filled_by.empty()) of_commands += "          " + command.filled_by + "\n";
    of_commands += "          ;;\n";
  }
  // A program without commands has no names; nothing typed is this.
  if (names.empty()) names.push_back("'-'");
  std::map<std::string, Words> by_value;
  for (const auto& [option, says] : values) by_value[says].push_back(option);
  for (const auto& [says, options] : by_value) {
    of_values += fmt::format("    {}) {} ;;\n", fmt::join(options, " | "), says);
  }
  return fmt::format(kScript, fmt::arg("program", app.get_name()),
                     fmt::arg("names", fmt::join(names, " | ")), fmt::arg("values", of_values),
                     fmt::arg("commands", of_commands));
}

}  // namespace fogbench::daemon
