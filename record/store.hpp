#pragma once
// The run log's file: where it is by default, its schema, and opening it.

#include <filesystem>
#include <memory>
#include <string_view>

#include "config/result.hpp"
#include "record/sqlite.hpp"

namespace fogbench::record {

/// "FOGB", in the file's header: tells a run log from any other database.
inline constexpr int kApplicationId = 0x464F4742;
inline constexpr int kSchemaVersion = 2;

/// $FOGBENCH_STORE; else $XDG_STATE_HOME/fogbench/fogbench.db; else
/// ~/.local/state/fogbench/fogbench.db. kBadInput when none of the variables is set.
Result<std::filesystem::path> default_store();

/// The file beside a run log that belongs to it, `suffix` ".queue": the same one by whatever link
/// the run log is named.
std::filesystem::path beside_store(const std::filesystem::path& store, std::string_view suffix);

/// Makes the missing folders of the default run log; of any other, nothing.
void make_default_folder(const std::filesystem::path& store);

/// Opens a run log for reading. Errors: kBadInput (no such file, not a run log, newer schema),
/// kStore (locked, unreadable).
Result<std::unique_ptr<Database>> open_store(const std::filesystem::path& path);

/// Opens a run log for writing and makes it when there is none: a new one appears complete or not
/// at all. An empty file becomes one, and so does what a link points to. Missing folders are made
/// for the default store only.
Result<std::unique_ptr<Database>> open_store_for_writing(const std::filesystem::path& path);

/// Adds the column of a channel that the table lacks, and describes it; nothing where it is there.
/// Precondition: the names are a table's and an identifier.
Status add_column(Database& database, std::string_view table, std::string_view name,
                  std::string_view meaning);

}  // namespace fogbench::record
