#pragma once
// Tables in MATLAB's files, level 4, 5 and 7.3 (what Octave's save -v4, -v6, -v7 and scipy write
// too), through libmatio: a struct of vectors of one length, vectors beside each other, or a matrix
// whose columns a list of strings names.

#include <filesystem>
#include <string>

#include "config/result.hpp"
#include "model/table/stored_columns.hpp"

namespace fogbench::model {

/// `wanted` names a variable, empty: the only table in the file ("variables": the vectors beside
/// each other). Errors: kBadInput without the file's name.
Result<StoredColumns> read_mat(const std::filesystem::path& file, const std::string& wanted);

}  // namespace fogbench::model
