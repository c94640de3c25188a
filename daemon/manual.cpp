#include "daemon/manual.hpp"

#include <fmt/format.h>

#include <sstream>
#include <string_view>

#include "daemon/bash_completion.hpp"

namespace fogbench::daemon {
namespace {

/// Text that roff takes as it is.
std::string plain(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      escaped += c;
    }
  }
  // A line that begins so would be a request.
  if (escaped.starts_with('.') || escaped.starts_with('\'')) escaped.insert(0, "\\&");
  return escaped;
}

/// Lines as they are, in one block.
std::string block(const std::string& text) {
  std::string page = ".nf\n";
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) page += plain(line) + "\n";
  return page + ".fi\n";
}

std::string item(const std::string& name, const std::string& meaning) {
  return fmt::format(".TP\n\\fB{}\\fR\n{}\n", plain(name), plain(meaning));
}

std::string option_item(const CLI::Option& option) {
  const std::string name =
      option.get_positional() ? option.get_name(true) : option.get_name(false, true);
  const bool value = !option.get_positional() && option.get_items_expected_max() > 0;
  std::string heading = fmt::format("\\fB{}\\fR", plain(name));
  if (value) heading += fmt::format(" \\fI{}\\fR", plain(option.get_type_name()));
  std::string meaning = option.get_description();
  if (option.get_required()) meaning += " (required)";
  return fmt::format(".TP\n{}\n{}\n", heading, plain(meaning));
}

std::string option_items(const CLI::App& app) {
  std::string page;
  for (const bool positional : {true, false}) {
    for (const CLI::Option* option : app.get_options()) {
      if (option->get_positional() == positional) page += option_item(*option);
    }
  }
  return page;
}

/// A command and those below it.
std::string command_sections(const CLI::App& command, const std::string& above) {
  const std::string name = above + " " + command.get_name();
  std::string page =
      fmt::format(".SS \"{}\"\n{}.\n", plain(name), plain(command.get_description()));
  page += option_items(command);
  if (!command.get_footer().empty()) page += ".PP\n" + block(command.get_footer());
  for (const CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; })) {
    page += command_sections(*below, name);
  }
  return page;
}

std::string items(const std::string& heading,
                  const std::vector<std::pair<std::string, std::string>>& entries) {
  std::string page = entries.empty() ? "" : ".SH " + heading + "\n";
  for (const auto& [name, meaning] : entries) page += item(name, meaning);
  return page;
}

}  // namespace

void add_manual_options(CLI::App& app) {
  // asked_manual() takes it where it may stand.
  const auto refuse = [](const std::string&) { return std::string("takes no other arguments"); };
  const std::string manual = "Print the manual page, for man(1), and do nothing else";
  const std::string completion = "Print the completion for bash, and do nothing else";
  app.add_flag("--manual", manual)->check(refuse);
  app.add_flag("--completion", completion)->check(refuse);
}

std::optional<std::string> asked_manual(int argc, const char* const* argv, const CLI::App& app,
                                        const ManualText& text) {
  const std::string_view asked = argc == 2 ? argv[1] : "";
  if (asked == "--manual") return manual_page(app, text);
  if (asked == "--completion") return bash_completion(app);
  return std::nullopt;
}

std::string manual_page(const CLI::App& app, const ManualText& text) {
  const std::string name = app.get_name();
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  std::string page =
      fmt::format(".TH {} {} \"\" \"fogbench {}\"\n", name, text.section, FOGBENCH_VERSION);
  page += fmt::format(".SH NAME\n{} \\- {}\n", name, plain(text.summary));
  page += fmt::format(".SH SYNOPSIS\n\\fB{}\\fR {}\n", name,
                      commands.empty() ? "[\\fIOPTION\\fR...] [\\fIPROCEDURE\\fR...]"
                                       : "\\fICOMMAND\\fR [\\fIOPTION\\fR...]");
  page += ".SH DESCRIPTION\n" + plain(text.description) + "\n";
  page += ".SH OPTIONS\n" + option_items(app);
  if (!commands.empty()) page += ".SH COMMANDS\n";
  for (const CLI::App* command : commands) page += command_sections(*command, name);
  page += ".SH NOTES\n" + block(app.get_footer());
  page += items("ENVIRONMENT", text.environment) + items("FILES", text.files);
  return page + ".SH SEE ALSO\n" + plain(text.see_also) + "\n";
}

}  // namespace fogbench::daemon
