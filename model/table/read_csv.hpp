#pragma once
// Reads a measurement table from CSV in one pass through a fixed buffer: memory is that of the
// columns, whatever the file holds, and the columns are as short as the caller wants them.

#include <filesystem>
#include <limits>
#include <map>
#include <string>

#include "config/result.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

inline constexpr std::size_t kEveryRow = std::numeric_limits<std::size_t>::max();

/// Reads a table of text: first line names, lines at most 1 MiB; comments ('#', '%', "//"), empty
/// lines and columns without a name skipped. Commas between fields and '.' decimals, or what
/// dialect.hpp recognises on the first lines, which Table::written() says. Missing is nothing, NaN,
/// NA, N/A, #N/A, null or '-'. `renames` maps a wanted name to the file's ("rate_deg_per_h" ->
/// "omega"); the column that had the wanted name, if any, is dropped. Text in a column of numbers
/// is kBadInput with file, line and column; a column that is not of the measurement table is
/// dropped instead.
///
/// Of a file with more than `most_rows` rows, neighbours of one run and segment are averaged while
/// it is read, so that memory is bounded by `most_rows`: a duration becomes the sum, a standard
/// error that of the mean. Where the rows of a run are not in order of time, all are kept.
Result<Table> read_csv(const std::filesystem::path& file,
                       const std::map<std::string, std::string>& renames = {},
                       std::size_t most_rows = kEveryRow);

}  // namespace fogbench::model
