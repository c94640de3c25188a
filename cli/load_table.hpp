#pragma once
// The DATA argument that the model's commands share: a run of the store, or a CSV file.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "model/table/read_csv.hpp"

namespace fogbench::cli {

struct DataOptions {
  std::vector<std::string> data;     ///< each "7", "STORE.db#7" or "file.csv"
  std::vector<std::string> columns;  ///< "wanted=name"
  std::vector<std::string> units;    ///< "name=unit", of columns whose names do not say it
  std::string segment;               ///< glob; empty: every row
  std::string store;                 ///< for bare run numbers; empty: the default store
  bool unfinished = false;           ///< also runs that were not completed
};

enum class DataCount { kOne, kSeveral };

/// Declares DATA, --column, --segment, --unfinished and --store on a command.
void add_data_options(CLI::App& command, DataOptions& options, DataCount count = DataCount::kOne);

/// What "7" or "STORE.db#7" names.
struct RunInStore {
  std::string store;  ///< empty: the default one
  std::int64_t run = 0;
};

/// Empty for a CSV file.
std::optional<RunInStore> run_in_store(const std::string& data, const DataOptions& options);

/// For headings: "run 7", "STORE.db#7, file.csv".
std::string data_name(const DataOptions& options);

/// DATA and its options as a shell takes them, for a command that is proposed next.
std::string data_arguments(const DataOptions& options);

/// The command that goes on from a model which lacks nothing: fit it, or use it where it is fitted.
std::string command_with_adequate(const DataOptions& options, const std::string& model,
                                  bool fitted);

/// The tables one after the other. With several, the run of each row is "DATA/run", so that test 1
/// of two records stays two runs.
/// Of a longer CSV file neighbouring rows are averaged (model/table/read_csv.hpp).
/// Errors: kBadInput (no such file or run, not CSV, no row matches the segment), kStore.
Result<model::Table> load_table(const DataOptions& options,
                                std::size_t most_rows = model::kEveryRow);

}  // namespace fogbench::cli
