#pragma once
// The DATA argument that the model's commands share: a run of the store, or a file that holds a
// table.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/model_file.hpp"
#include "config/result.hpp"
#include "model/table/read_options.hpp"
#include "model/table/table.hpp"

namespace fogbench::cli {

struct DataOptions {
  /// Each "7", "7/1" (test 1 of it), "STORE.db#7", "file.csv" or "file.mat#log".
  std::vector<std::string> data;
  std::vector<std::string> columns;  ///< "wanted=name"
  std::vector<std::string> units;    ///< "name=unit", of columns whose names do not say it
  std::string segment;               ///< glob; empty: every row
  std::string store;                 ///< for bare run numbers; empty: the default store
  std::vector<std::string> tests;    ///< only these; empty: every one
  bool unfinished = false;           ///< also runs that were not completed
  bool several_gyros = false;        ///< runs of more gyros than one may stand in one table
};

enum class DataCount { kOne, kOneOrTwo, kSeveral };

/// Declares DATA and the options that go with it on a command.
void add_data_options(CLI::App& command, DataOptions& options, DataCount count = DataCount::kOne);

/// What "7", "7/1" or "STORE.db#7" names.
struct RunInStore {
  std::string store;  ///< empty: the default one
  std::int64_t run = 0;
  std::string test;  ///< empty: all of it
};

/// Empty for a file that holds a table.
std::optional<RunInStore> run_in_store(const std::string& data, const DataOptions& options);

/// The file of "FILE" or "FILE#NAME", a table inside it.
std::string file_of(const std::string& data);

/// The serial number of the gyro that it measured; empty where that is not on record, as for a CSV
/// file.
Result<std::string> gyro_of(const std::string& data, const DataOptions& options);

/// One gyro measured all of `data`, as far as that is on record, or --several-gyros was given.
Status expect_one_gyro(const std::vector<std::string>& data, const DataOptions& options);

/// For headings: "run 7", "STORE.db#7, file.csv".
std::string data_name(const DataOptions& options);

/// DATA and its options as a shell takes them, for a command that is proposed next.
std::string data_arguments(const DataOptions& options);

/// The command that goes on from a model which lacks nothing: fit it, or use it where it is fitted.
std::string command_with_adequate(const DataOptions& options, const std::string& model,
                                  bool fitted);

/// What a caller knows of the tables that it wants.
struct LoadHow {
  /// The model that they are for: a column that it names is not taken for another one.
  const config::ModelFile* model = nullptr;
  std::size_t most_rows = model::kEveryRow;  ///< model/table/read_options.hpp
  bool need_all = true;                      ///< the same
};

/// One file or run. What was recognised in it, and what is doubtful, is said on stderr and stands
/// in its provenance.
Result<model::Table> load_one(const std::string& data, const DataOptions& options,
                              const LoadHow& how = {});

/// The tables one after the other. With several, the run of each row is "DATA/test", so that test
/// 1 of two records stays two.
/// Errors: kBadInput (no such file or run, no table, no row matches the test or the segment,
/// runs of several gyros), kStore.
Result<model::Table> load_table(const DataOptions& options, const LoadHow& how = {});

}  // namespace fogbench::cli
