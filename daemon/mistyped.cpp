#include "daemon/mistyped.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "config/nearest_name.hpp"

namespace fogbench::daemon {
namespace {

/// Of the commands; a group of options has no name.
std::vector<std::string> names_below(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; })) {
    if (!below->get_name().empty()) names.push_back(below->get_name());
  }
  return names;
}

/// `name` is one of `known`, or the line that says what was meant.
std::string unknown_among(const char* what, std::string_view name,
                          const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), name) != known.end()) return "";
  return fmt::format("unknown {} {}{}", what, name,
                     config::did_you_mean(name, {known.begin(), known.end()}));
}

/// "-o" and "-ofile", where the command has -o, and what is a negative number are none of these.
bool unknown_letter(const CLI::App& command, const std::string& argument) {
  return argument.size() > 1 && argument[0] == '-' &&
         std::isalpha(static_cast<unsigned char>(argument[1])) != 0 &&
         command.get_option_no_throw(argument.substr(0, 2)) == nullptr;
}

std::vector<std::string> long_options(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (const CLI::App* group : command.get_subcommands([](const CLI::App*) { return true; })) {
    if (!group->get_name().empty()) continue;
    const std::vector<std::string> more = long_options(*group);
    names.insert(names.end(), more.begin(), more.end());
  }
  return names;
}

}  // namespace

std::string mistyped(const CLI::App& app, const std::vector<std::string>& arguments,
                     const CLI::ParseError& error) {
  const CLI::App* command = &app;
  std::string path = app.get_name();
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    std::string unknown;
    if (argument.starts_with("--") || unknown_letter(*command, argument)) {
      unknown =
          unknown_among("option", argument.substr(0, argument.find('=')), long_options(*command));
    } else if (const std::vector<std::string> names = names_below(*command); !names.empty()) {
      unknown = unknown_among("command", argument, names);
      if (unknown.empty()) {
        command = command->get_subcommand(argument);
        path += " " + argument;
      }
    }
    if (!unknown.empty()) return fmt::format("{} (see {} --help)", unknown, path);
  }
  return fmt::format("{} (see {} --help)", error.what(), path);
}

}  // namespace fogbench::daemon
