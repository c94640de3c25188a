#pragma once
// Writes a measurement table as read_table reads it.

#include <filesystem>

#include "config/result.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// Columns run and segment (where they say something), then the numbers by name; numbers with the
/// shortest exact digits, missing ones empty. The file appears whole or not at all.
Status write_csv(const Table& table, const std::filesystem::path& file);

}  // namespace fogbench::model
