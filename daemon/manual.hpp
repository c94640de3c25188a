#pragma once
// What a program says of itself to a packager: its manual page and its shell completion, made from
// the options that it declares, so that neither can differ from what it does.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace fogbench::daemon {

/// What the options do not say.
struct ManualText {
  int section = 1;
  std::string summary;  ///< after the name and a dash
  std::string description;
  /// Name and meaning each.
  std::vector<std::pair<std::string, std::string>> environment, files;
  std::string see_also;
};

/// Adds --manual and --completion, so that --help shows them.
void add_manual_options(CLI::App& app);

/// What the only argument asks for; nothing when it is neither of them. Before the command line is
/// read, which would ask for more.
std::optional<std::string> asked_manual(int argc, const char* const* argv, const CLI::App& app,
                                        const ManualText& text);

/// For man(1), in roff.
std::string manual_page(const CLI::App& app, const ManualText& text);

}  // namespace fogbench::daemon
