// The names of helpers, which a build that compiles a room's sources as one throws together.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <regex>

#include "tests/architecture/rules.hpp"

namespace fogbench::tests {
namespace {

/// The free functions whose first parameter is of a standard or fundamental type, or which have
/// none. clang-format leaves a function of a namespace, and nothing of a class, at a line's start.
std::set<std::string> plain_functions(std::string_view code) {
  static const std::regex kFunction(
      R"((?:\[\[nodiscard\]\] )?[A-Za-z_][\w:<>,&* ]*[ &*>]([a-z_][a-z0-9_]*)\(\s*)"
      R"((?:\)|(?:const )?(?:std::|fs::|)"
      R"((?:auto|bool|char|double|float|int|long|short|signed|size_t|unsigned|void)\b)))");
  std::set<std::string> names;
  for (std::size_t begin = 0, end = 0; begin < code.size(); begin = end + 1) {
    end = std::min(code.find('\n', begin), code.size());
    if (std::isalpha(static_cast<unsigned char>(code[begin])) == 0 && code[begin] != '[') continue;
    std::size_t stop = end;
    if (code[end - 1] == '(') stop = std::min(code.find('\n', end + 1), code.size());
    std::cmatch match;
    if (std::regex_search(code.data() + begin, code.data() + stop, match, kFunction,
                          std::regex_constants::match_continuous)) {
      names.insert(match[1]);
    }
  }
  return names;
}

/// One past the brace that closes the one at `open`.
std::size_t end_of_block(std::string_view code, std::size_t open) {
  int depth = 0;
  for (std::size_t at = open; at < code.size(); ++at) {
    depth += code[at] == '{' ? 1 : code[at] == '}' ? -1 : 0;
    if (depth == 0) return at + 1;
  }
  return code.size();
}

/// The plain functions of the file's anonymous namespaces.
std::set<std::string> plain_helpers(std::string_view code) {
  static constexpr std::string_view kAnonymous = "namespace {";
  std::set<std::string> names;
  for (std::size_t at = code.find(kAnonymous); at != std::string_view::npos;) {
    const std::size_t end = end_of_block(code, at + kAnonymous.size() - 1);
    names.merge(plain_functions(code.substr(at, end - at)));
    at = code.find(kAnonymous, end);
  }
  return names;
}

/// What is compiled as one: a room, or a folder of tests/.
std::string unit_of(const SourceFile& file) {
  return file.path.substr(0, file.path.find('/', file.folder() == "tests" ? 6 : 0));
}

}  // namespace

Violations shared_helper_names(const Tree& tree) {
  std::map<std::string, std::string> in_headers;
  for (const SourceFile& file : tree) {
    if (!file.path.ends_with(".hpp") || !kMaySee.contains(file.folder())) continue;
    for (const std::string& name : plain_functions(file.code)) in_headers.emplace(name, file.path);
  }
  Violations found;
  const auto report = [&](const SourceFile& file, const std::string& other,
                          const std::string& name) {
    found.push_back(fmt::format(
        "{} and {} both have a function `{}` of a standard type: sources are compiled as one, and "
        "a call may pick the other file's; give one a name that tells more",
        file.path, other, name));
  };
  std::map<std::pair<std::string, std::string>, std::string> in_sources;
  for (const SourceFile& file : tree) {
    const bool is_source = file.path.ends_with(".cpp");
    if (!is_source && file.folder() != "tests") continue;
    const auto names = is_source ? plain_helpers(file.code) : plain_functions(file.code);
    for (const std::string& name : names) {
      const auto header = in_headers.find(name);
      if (header != in_headers.end()) report(file, header->second, name);
      const auto [first, is_new] = in_sources.try_emplace({unit_of(file), name}, file.path);
      if (!is_new) report(file, first->second, name);
    }
  }
  return found;
}

}  // namespace fogbench::tests
