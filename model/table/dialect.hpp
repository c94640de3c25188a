#pragma once
// How a file writes its table: what stands between its fields, how it writes a decimal, where its
// names and units stand. Recognised on its first 64 KiB, and never guessed: what may be read in two
// ways is an error that names both.

#include <string>
#include <string_view>
#include <vector>

#include "config/result.hpp"
#include "model/table/time_stamp.hpp"

namespace fogbench::model {

struct Dialect {
  char separator = ',';            ///< ' ' is any run of blanks and tabs
  bool decimal_comma = false;      ///< "1,5" is one and a half
  std::vector<std::string> names;  ///< "1", "2", ... where the file has none
  std::vector<std::string> units;  ///< of the row below the names; empty: there is none
  std::size_t names_line = 0;      ///< 0: the file has no names
  std::size_t lines_before = 0;    ///< how many lines stand before the first row of the table
  std::size_t preamble = 0;        ///< lines that are neither comment nor table
  bool commented_names = false;    ///< "# time rate"
  bool row_names = false;          ///< each row begins with a name of its own: names[0] is empty
  SlashDate dates = SlashDate::kUnknown;

  char decimal() const { return decimal_comma ? ',' : '.'; }
  /// "separated by semicolons, with decimal commas, units in the row below the names"; empty for
  /// names and numbers between commas.
  std::string says() const;
};

/// A line that tells people something: it begins with '#', '%' or "//".
bool is_comment(std::string_view line);

/// Of the first lines of a text; `whole`: they are all of it, else the last one may be cut off.
/// Errors: kBadInput, without a file's name: thousands separators, points and commas as decimals
/// beside each other, a number that may be read in two ways.
Result<Dialect> recognise(std::string_view head, bool whole);

}  // namespace fogbench::model
