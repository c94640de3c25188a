#include "tests/architecture/source_tree.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <iterator>
#include <regex>

namespace fogbench::tests {
namespace fs = std::filesystem;
namespace {

bool is_read(const fs::path& file, const std::string& relative) {
  static constexpr std::array kExtensions{".cpp", ".hpp", ".in", ".cmake",
                                          ".css", ".js",  ".md", ".txt"};
  return std::find(kExtensions.begin(), kExtensions.end(), file.extension()) != kExtensions.end() ||
         relative.starts_with("scripts/") || relative.starts_with(".ci/");
}

bool is_left_out(const fs::path& folder) {
  const std::string name = folder.filename().string();
  return name == "build" || name == "demo" || (name.starts_with('.') && name != ".ci") ||
         fs::exists(folder / "CMakeCache.txt");
}

std::string contents(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Where the comment or literal that opens at `at` ends, one past its last character; `at` itself
/// when none opens there.
std::size_t end_of_comment(std::string_view text, std::size_t at) {
  if (text.substr(at, 2) == "//") return std::min(text.find('\n', at), text.size());
  if (text.substr(at, 2) != "/*") return at;
  const std::size_t close = text.find("*/", at + 2);
  return close == std::string_view::npos ? text.size() : close + 2;
}

std::size_t end_of_literal(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const bool after_word = at > 0 && is_word(text[at - 1]);
  if (quote == '"' && at > 0 && text[at - 1] == 'R') {
    const std::size_t open = text.find('(', at);
    if (open == std::string_view::npos) return text.size();
    const std::string closing = ")" + std::string(text.substr(at + 1, open - at - 1)) + "\"";
    const std::size_t close = text.find(closing, open);
    return close == std::string_view::npos ? text.size() : close + closing.size();
  }
  // A quote after a digit separates thousands.
  if (quote != '"' && (quote != '\'' || after_word)) return at;
  std::size_t end = at + 1;
  while (end < text.size() && text[end] != quote && text[end] != '\n') {
    end += text[end] == '\\' ? 2 : 1;
  }
  return std::min(end + 1, text.size());
}

}  // namespace

std::string_view SourceFile::folder() const {
  const std::size_t slash = path.find('/');
  return slash == std::string::npos ? std::string_view{} : std::string_view(path).substr(0, slash);
}

std::vector<SourceFile> read_tree(const fs::path& root) {
  std::vector<SourceFile> files;
  for (auto entry = fs::recursive_directory_iterator(root); entry != fs::end(entry); ++entry) {
    if (entry->is_directory()) {
      if (is_left_out(entry->path())) entry.disable_recursion_pending();
      continue;
    }
    SourceFile file;
    file.path = entry->path().lexically_relative(root).generic_string();
    if (!entry->is_regular_file() || !is_read(entry->path(), file.path)) continue;
    file.text = contents(entry->path());
    if (file.is_cpp()) {
      file.code = blank_comments(file.text, false);
      file.includes = blank_comments(file.text, true);
    }
    files.push_back(std::move(file));
  }
  std::sort(files.begin(), files.end(),
            [](const SourceFile& a, const SourceFile& b) { return a.path < b.path; });
  return files;
}

std::string blank_comments(std::string_view text, bool keep_literals) {
  std::string out(text);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t comment = end_of_comment(text, at);
    const std::size_t end = comment == at ? end_of_literal(text, at) : comment;
    if (comment != at || !keep_literals) {
      for (std::size_t i = at; i < end; ++i) {
        if (out[i] != '\n') out[i] = ' ';
      }
    }
    at = std::max(end, at + 1);
  }
  return out;
}

std::vector<std::string> quoted_includes(const SourceFile& file) {
  static const std::regex kInclude("^[ \t]*#[ \t]*include[ \t]*\"([^\"\n]+)\"",
                                   std::regex::multiline);
  std::vector<std::string> found;
  for (std::sregex_iterator it(file.includes.begin(), file.includes.end(), kInclude), end;
       it != end; ++it) {
    found.push_back((*it)[1]);
  }
  return found;
}

std::vector<std::string> cmake_words(const SourceFile& file) {
  static const std::regex kComment("#[^\n]*");
  static const std::regex kWord("[^\\s()]+");
  const std::string text = std::regex_replace(file.text, kComment, "");
  return {std::sregex_token_iterator(text.begin(), text.end(), kWord),
          std::sregex_token_iterator()};
}

std::size_t line_count(std::string_view text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace fogbench::tests
