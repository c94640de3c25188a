#pragma once
// A file of binary data may hold several things that could be the table.

#include <string>
#include <vector>

#include "config/result.hpp"
#include "model/table/stored_columns.hpp"

namespace fogbench::model {

struct TableCandidate {
  std::string name;  ///< as the file calls it
  std::vector<StoredColumn> columns;
};

/// Of the columns those that have as many rows as most have, `left_out` the names of the others; a
/// single value is no column.
std::vector<StoredColumn> of_one_length(std::vector<StoredColumn> columns,
                                        std::vector<std::string>& left_out);

/// The candidate called `wanted`, or the only one where `wanted` is empty. Errors: kBadInput, which
/// lists the candidates as FILE#NAME; `nothing` says what was expected where there is none.
Result<StoredColumns> the_table(std::vector<TableCandidate> candidates, const std::string& wanted,
                                const std::string& format, const std::string& nothing);

}  // namespace fogbench::model
