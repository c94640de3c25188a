#pragma once
// Reads a measurement table from text in one pass through a fixed buffer: memory is that of the
// columns, whatever the file holds, and the columns are as short as the caller wants them.

#include <filesystem>

#include "config/result.hpp"
#include "model/table/byte_source.hpp"
#include "model/table/read_options.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// More names are no measurement table.
inline constexpr std::size_t kMostColumns = 4096;

/// Reads a table of text in any encoding of text_source.hpp and any dialect of dialect.hpp: a line
/// of names, commas between fields and '.' decimals, or what is recognised on the first 64 KiB,
/// which Table::provenance() says. Lines are at most 1 MiB; comments ('#', '%', "//"), empty lines
/// and columns without a name are skipped. Missing is nothing, NaN, NA, N/A, #N/A, null, '-' and
/// their like. Columns are chosen, and their units taken to the house's, by choose_columns.hpp; a
/// column that becomes time_s may hold dates (time_stamp.hpp), which become seconds since 1970.
/// Text in a column of numbers is kBadInput with file, line and column; a column that is not of the
/// measurement table is dropped instead.
///
/// Of a file with more than `most_rows` rows, neighbours of one run and segment are averaged while
/// it is read, so that memory is bounded by `most_rows`: a duration becomes the sum, a standard
/// error that of the mean. Where the rows of a run are not in order of time, all are kept, for
/// which the file is read again.
Result<Table> read_text_table(const std::filesystem::path& file, OpenedBytes opened,
                              const ReadOptions& options);

}  // namespace fogbench::model
