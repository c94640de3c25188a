#pragma once
// How results are printed: tables of text with the units in the heading, or one JSON document.
// Results go to stdout; logs, progress and errors go to stderr.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "config/result.hpp"

namespace fogbench::cli {

/// Columns padded to their widest cell; numbers to the right, so that their units line up.
class TextTable {
 public:
  enum class Align { kLeft, kRight };
  struct Column {
    std::string title;
    std::string unit;  ///< printed under the title; may be empty
    Align align = Align::kRight;
  };

  explicit TextTable(std::vector<Column> columns);
  /// Precondition: one cell per column.
  void add_row(std::vector<std::string> cells);
  bool empty() const { return rows_.empty(); }
  /// Heading, units (when any column has one), a rule and the rows, each line ended. With a width,
  /// the last column's cells are broken at blanks so that no line is longer, where that is
  /// possible.
  std::string text(std::size_t width = 0) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// How wide a text may be, so that it stands on paper and in most windows.
inline constexpr std::size_t kTextWidth = 100;
/// Lines of at most `width`, broken at blanks; a longer word stands alone.
std::vector<std::string> wrapped(const std::string& text, std::size_t width);

/// Ended lines of at most kTextWidth, each with the indent; further ones stand two farther right.
std::string wrapped(const std::string& text, const std::string& indent);

/// `value` with that many decimals; "-" for NaN (missing).
std::string fixed(double value, int decimals);
/// Value and one standard error to two digits of the error: "0.0123 +- 0.0045".
std::string with_error(double value, double standard_error);

/// One document and a newline on stdout. NaN becomes null, bytes that are not UTF-8 a question
/// mark.
void print_json(const nlohmann::ordered_json& document);

/// One line "fogbench: ..." on stderr.
void print_error(const std::string& message);
/// One line "fogbench: note: ..." on stderr: the result stands, but the reader should know.
void print_note(const std::string& message);
/// The same, printed when the command has ended with a result: an error is one line by itself.
void note_beside_result(std::string message);
void print_notes_beside_result();
/// One line for an error and what was noted before it.
Error with_notes(Error error, const std::vector<std::string>& notes);

/// True when stderr is a terminal, so that a progress line may overwrite itself there.
bool progress_wanted();

}  // namespace fogbench::cli
