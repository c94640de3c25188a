#pragma once
// Tables in HDF5 files: a group of data sets of one length, a data set of records, or a matrix with
// an attribute that names its columns. Units are taken from attributes ("units", "unit").

#include <filesystem>
#include <string>

#include "config/result.hpp"
#include "model/table/stored_columns.hpp"

namespace fogbench::model {

/// `wanted` names a group or a data set ("/run1"), empty: the only table in the file. Errors:
/// kBadInput without the file's name.
Result<StoredColumns> read_hdf5(const std::filesystem::path& file, const std::string& wanted);

}  // namespace fogbench::model
