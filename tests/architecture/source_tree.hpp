#pragma once
// The project's own text, read for the rules that the compiler cannot keep.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace fogbench::tests {

struct SourceFile {
  std::string path;      ///< relative to the tree's root, with '/'
  std::string text;      ///< as it is on disk
  std::string code;      ///< C++ only: comments and literals blanked, line breaks kept
  std::string includes;  ///< C++ only: comments blanked, literals kept

  bool is_cpp() const { return path.ends_with(".cpp") || path.ends_with(".hpp"); }
  bool is_cmake() const { return path.ends_with("CMakeLists.txt") || path.ends_with(".cmake"); }
  /// The top-level folder, or empty for a file of the root.
  std::string_view folder() const;
};

/// Every text that people write by hand (C++, CMake, pages, scripts, documents), sorted by path.
/// Build trees, hidden folders except .ci, and the demo's output are left out.
std::vector<SourceFile> read_tree(const std::filesystem::path& root);

/// Blanks comments, and literals unless `keep_literals`; line breaks stay where they were.
std::string blank_comments(std::string_view text, bool keep_literals);

/// The quoted includes of one file, as written.
std::vector<std::string> quoted_includes(const SourceFile& file);

/// The words of a CMake file, comments left out.
std::vector<std::string> cmake_words(const SourceFile& file);

std::size_t line_count(std::string_view text);

}  // namespace fogbench::tests
