#pragma once
// The one reader of measurement tables in files: whatever the format, recognised by the file's
// first bytes and not by its name.

#include <filesystem>
#include <string>

#include "config/result.hpp"
#include "model/table/read_options.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// Text, packed with gzip or zstd or not (read_text.hpp), MATLAB's files (read_mat.hpp), HDF5
/// (read_hdf5.hpp). `inside` names a table in a file that holds several. Errors: kBadInput with the
/// file's name and, of text, line and column.
Result<Table> read_table(const std::filesystem::path& file, const ReadOptions& options = {},
                         const std::string& inside = {});

}  // namespace fogbench::model
