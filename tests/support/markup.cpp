#include "tests/support/markup.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <vector>

namespace fogbench::support {
namespace {

constexpr std::array<std::string_view, 4> kVoid = {"meta", "input", "br", "link"};

/// Where the tag that begins at `at` ends: the '>' outside quotes; npos: nowhere.
std::size_t end_of_tag(std::string_view page, std::size_t at) {
  bool quoted = false;
  for (; at < page.size(); ++at) {
    if (page[at] == '"') quoted = !quoted;
    if (quoted && page[at] == '<') return std::string_view::npos;
    if (!quoted && page[at] == '>') return at;
  }
  return std::string_view::npos;
}

}  // namespace

std::string markup_error(const std::string& page) {
  std::vector<std::string> open;
  for (std::size_t at = page.find('<'); at != std::string::npos; at = page.find('<', at)) {
    const std::size_t end = end_of_tag(page, at);
    const std::string text = page.substr(at, std::min<std::size_t>(end - at, 40));
    if (end == std::string::npos) return "a tag does not end: " + text;
    const bool closes = page[at + 1] == '/';
    const std::size_t from = at + (closes ? 2 : 1);
    std::size_t to = from;
    while (std::isalnum(static_cast<unsigned char>(page[to])) != 0) ++to;
    const std::string name = page.substr(from, to - from);
    at = end;
    if (page[from] == '!') continue;
    if (name.empty()) return "a bare '<': " + text;
    if (closes) {
      if (open.empty() || open.back() != name) {
        return text + "> closes " + (open.empty() ? "nothing" : "<" + open.back() + ">");
      }
      open.pop_back();
      continue;
    }
    if (page[end - 1] == '/' || std::find(kVoid.begin(), kVoid.end(), name) != kVoid.end())
      continue;
    open.push_back(name);
    // What stands in these is not markup.
    if (name == "script" || name == "style") at = page.find("</" + name, end);
    if (at == std::string::npos) return "<" + name + "> is never closed";
  }
  return open.empty() ? "" : "<" + open.back() + "> is never closed";
}

}  // namespace fogbench::support
