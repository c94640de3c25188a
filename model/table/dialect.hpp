#pragma once
// How a file writes its table, where that is not with commas and points: exports of a spreadsheet
// in German or Russian, columns between tabs or blanks. Recognised on its first lines, and never
// guessed: what may be read in two ways is an error that names both.

#include <span>
#include <string>
#include <string_view>

#include "config/result.hpp"

namespace fogbench::model {

struct Dialect {
  char separator = ',';        ///< ' ' is any run of blanks
  bool decimal_comma = false;  ///< "1,5" is one and a half

  bool plain() const { return separator == ',' && !decimal_comma; }
  /// "separated by semicolons, with decimal commas".
  std::string says() const;
  /// The line with commas between its fields and points in its numbers.
  std::string plain_line(std::string_view line) const;
};

/// A line that tells people something: it begins with '#', '%' or "//".
bool is_comment(std::string_view line);

/// Of the line of names and some lines of data that follow it. Errors: kBadInput, without a file's
/// name: thousands separators, points and commas as decimals beside each other, a number that may
/// be a thousand times as large.
Result<Dialect> recognise(std::string_view names, std::span<const std::string> rows);

}  // namespace fogbench::model
