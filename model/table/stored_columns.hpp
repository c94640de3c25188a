#pragma once
// Columns as a file of binary data holds them, on their way into a table.

#include <filesystem>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "model/table/choose_columns.hpp"
#include "model/table/read_options.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

struct StoredColumn {
  SourceColumn source;
  std::vector<double> values;
  std::vector<std::string> texts;  ///< of a column of text; then there are no values
  std::size_t rows() const { return texts.empty() ? values.size() : texts.size(); }
};

/// What a library found in a file.
struct StoredColumns {
  std::string how;  ///< "MATLAB 5, struct log": for the provenance
  std::vector<StoredColumn> columns;
};

/// The columns that `options` choose, in the house's units. Of more rows than `options` take,
/// neighbours are averaged. Precondition: all have the same number of rows. Errors: kBadInput with
/// the file's name, as read_text_table's.
Result<Table> table_of(const std::filesystem::path& file, StoredColumns stored,
                       const ReadOptions& options);

}  // namespace fogbench::model
