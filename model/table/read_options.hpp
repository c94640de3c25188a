#pragma once
// What a caller may say about the tables that it reads.

#include <limits>
#include <map>
#include <set>
#include <string>

namespace fogbench::model {

inline constexpr std::size_t kEveryRow = std::numeric_limits<std::size_t>::max();

struct ReadOptions {
  /// Wanted name -> the file's ("rate_deg_per_h" -> "omega"); the column that had the wanted name,
  /// if any, is dropped. "-" for the file's: none is to be taken for it.
  std::map<std::string, std::string> columns;
  /// A column's name in the file -> the unit that it is in.
  std::map<std::string, std::string> units;
  /// Names that are asked for as they stand: no such column is taken for another one.
  std::set<std::string> kept;
  /// Whether a column that `columns` or `units` name must be there.
  bool need_all = true;
  /// Of a file with more rows, neighbours are averaged while it is read (read_text.hpp).
  std::size_t most_rows = kEveryRow;
};

}  // namespace fogbench::model
