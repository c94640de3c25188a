// fogbench import: tables of others, as they come, made once into one clean table.

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/load_table.hpp"
#include "cli/output.hpp"
#include "cli/shell_word.hpp"
#include "config/column_unit.hpp"
#include "model/table/average_rows.hpp"
#include "model/table/join_tables.hpp"
#include "model/table/write_csv.hpp"

namespace fogbench::cli {
namespace {

struct ImportOptions {
  DataOptions data;
  std::string output, tolerance, average;
  bool json = false;
};

/// "60", "60 s", "1min": seconds, more than nothing.
Result<double> span_of_time(const char* option, const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [at, failure] = std::from_chars(text.data(), end, value);
  std::string_view unit(at, static_cast<std::size_t>(end - at));
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  const config::StatedUnit* const stated = config::unit_spelt(unit.empty() ? "s" : unit);
  const bool good = failure == std::errc() && std::isfinite(value) && value > 0.0 &&
                    stated != nullptr && stated->dimension == config::Dimension::kTime;
  if (good) return value * stated->factor;
  return Error{ErrorCode::kUsage,
               fmt::format("{} {}: a length of time was expected, such as '60 s'", option, text)};
}

/// Each by itself; a column that an option names need not be in all of them.
Result<std::vector<model::Table>> load_each(const DataOptions& options) {
  std::vector<model::Table> tables;
  for (const std::string& data : options.data) {
    auto table = load_one(data, options, {.need_all = options.data.size() == 1});
    if (!table) return table.error();
    tables.push_back(std::move(*table));
  }
  return tables;
}

Result<ExitStatus> run_import(const ImportOptions& options) {
  double tolerance_s = model::kMissing, average_s = 0.0;
  for (const auto& [option, text, value] :
       {std::tuple("--tolerance", &options.tolerance, &tolerance_s),
        std::tuple("--average", &options.average, &average_s)}) {
    if (text->empty()) continue;
    const auto seconds = span_of_time(option, *text);
    if (!seconds) return seconds.error();
    *value = *seconds;
  }
  auto tables = load_each(options.data);
  if (!tables) return tables.error();
  auto joined = model::join_tables(std::move(*tables), options.data.data, tolerance_s);
  if (!joined) return joined.error();
  model::Table table = std::move(joined->table);
  const std::size_t rows_read = table.rows();
  if (average_s > 0.0) {
    auto averaged = model::average_rows(table, average_s);
    if (!averaged) return averaged.error();
    table = std::move(*averaged);
  }
  if (Status written = model::write_csv(table, options.output); !written) return written.error();
  if (options.json) {
    print_json({{"file", options.output},
                {"rows_read", rows_read},
                {"rows", table.rows()},
                {"columns", table.column_names()},
                {"read_as", table.provenance()},
                {"joined", joined->says}});
    return ExitStatus::kDone;
  }
  for (const std::string& line : joined->says) fmt::print("{}\n", line);
  if (table.rows() != rows_read) {
    fmt::print("{} rows averaged over {:g} s each\n", rows_read, average_s);
  }
  fmt::print("Written to {}: {} rows of {}\nNext: fogbench inspect {}\n", options.output,
             table.rows(), fmt::join(table.column_names(), ", "), shell_word(options.output));
  return ExitStatus::kDone;
}

}  // namespace

void add_import(CLI::App& app, Action& action) {
  add_command<ImportOptions>(
      app, action, "import", "Make one clean table of files as other programs wrote them",
      "  fogbench import night.csv -o table.csv --unit gyro=deg/s\n"
      "  fogbench import gyro.csv.gz thermometer.mat -o table.csv --average '60 s'\n",
      [](CLI::App& command, ImportOptions& options) {
        add_data_options(command, options.data, DataCount::kSeveral);
        command.add_option("-o,--output", options.output, "CSV file to write")->required();
        command.add_option("--tolerance", options.tolerance,
                           "How far apart in time rows of two files may be to be one (default: "
                           "half the longer of their usual steps)");
        command.add_option("--average", options.average,
                           "Average samples over this length of time, such as '60 s'");
        command.add_flag("--json", options.json, "One JSON document");
      },
      run_import);
}

}  // namespace fogbench::cli
