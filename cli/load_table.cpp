#include "cli/load_table.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>

#include "acceptance/run_table.hpp"
#include "cli/common_options.hpp"
#include "cli/output.hpp"
#include "cli/shell_word.hpp"
#include "config/column_unit.hpp"
#include "config/units.hpp"
#include "record/export.hpp"
#include "record/run_log_reader.hpp"

namespace fogbench::cli {
namespace {

using Renames = std::map<std::string, std::string>;

std::optional<std::int64_t> run_number(std::string_view text) {
  std::int64_t run = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), run);
  if (error != std::errc{} || end != text.data() + text.size() || run < 1) return {};
  return run;
}

Result<Renames> parse_pairs(const std::vector<std::string>& given, const char* option,
                            const char* expected) {
  Renames pairs;
  for (const std::string& pair : given) {
    const std::size_t equals = pair.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == pair.size()) {
      return Error{ErrorCode::kUsage,
                   fmt::format("{} {}: {} was expected", option, pair, expected)};
    }
    pairs[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return pairs;
}

/// The unit that the column was measured in, by what was said of it or else by its name; null: it
/// is not known.
Result<const config::StatedUnit*> unit_of_source(const std::string& column, const Renames& units) {
  const auto said = units.find(column);
  if (said == units.end()) return config::unit_in_name(column);
  if (const config::StatedUnit* const unit = config::find_unit(said->second)) return unit;
  return Error{ErrorCode::kUsage,
               fmt::format("--unit {}: found the unit \"{}\", expected one of {}", column,
                           said->second, config::known_units())};
}

/// A column that was taken from one of another unit gets the house's numbers; said on stderr.
Status take_to_house_unit(const std::string& wanted, const std::string& from, const Renames& units,
                          model::Table& table) {
  const auto unit = unit_of_source(from, units);
  if (!unit) return unit.error();
  const config::StatedUnit* const target = config::find_unit(config::unit_of(wanted));
  if (*unit == nullptr || target == nullptr) return {};
  const config::StatedUnit& source = **unit;
  if (source.dimension != target->dimension) {
    // The end of a name may mean something else; what was said or stands in brackets does not.
    const bool stated = units.contains(from) || from.ends_with(']') || from.ends_with(')');
    if (!stated) return {};
    return Error{ErrorCode::kBadInput, fmt::format("column {}: is in {}, expected {} for {}", from,
                                                   source.name, target->name, wanted)};
  }
  if (source.factor == target->factor && source.offset == target->offset) return {};
  const auto stated = table.column(wanted);
  std::vector<double> values(stated.begin(), stated.end());
  for (double& value : values) {
    value = (value * source.factor + source.offset - target->offset) / target->factor;
  }
  table.set_column(wanted, std::move(values));
  print_note(fmt::format("{}: taken from {} in {} to {}", wanted, from, source.name, target->name));
  return {};
}

Result<model::Table> load_run(const std::string& store, std::int64_t run, const Renames& renames,
                              bool unfinished) {
  const auto path = store_to_read(store);
  if (!path) return path.error();
  auto reader = record::RunLogReader::open(*path);
  if (!reader) return reader.error();
  const auto points = record::valid_points(**reader, run, unfinished);
  if (!points) return points.error();
  const auto info = (*reader)->run(run);
  if (!info) return info.error();
  if (!info->completed()) {
    print_note(fmt::format("run {} was not completed ({})", run, info->outcome()));
  }
  model::Table table = acceptance::to_table(*points);
  for (const auto& [wanted, name] : renames) {
    if (!table.has(name)) {
      return Error{ErrorCode::kBadInput, fmt::format("run {}: no column {}", run, name)};
    }
    const auto values = table.column(name);
    table.set_column(wanted, {values.begin(), values.end()});
  }
  return table;
}

/// "7", "STORE.db#7" or a CSV file.
Result<model::Table> load_one(const std::string& data, const DataOptions& options,
                              const Renames& renames, const Renames& units, std::size_t most_rows) {
  const auto stored = run_in_store(data, options);
  auto table = stored ? load_run(stored->store, stored->run, renames, options.unfinished)
                      : model::read_csv(data, renames, most_rows);
  if (!table) return table;
  if (!table->written().empty()) print_note(data + ": read as " + table->written());
  for (const auto& [wanted, from] : renames) {
    const Status converted = take_to_house_unit(wanted, from, units, *table);
    if (!converted) return converted.error();
  }
  for (const auto& said : units) {
    const std::string& column = said.first;
    const bool is_renamed = std::any_of(renames.begin(), renames.end(), [&](const auto& rename) {
      return rename.second == column;
    });
    if (is_renamed) continue;
    if (!table->has(column)) {
      return Error{ErrorCode::kBadInput,
                   fmt::format("--unit {}: {} has no such column", column, data)};
    }
    const Status converted = take_to_house_unit(column, column, units, *table);
    if (!converted) return converted.error();
  }
  return table;
}

void name_runs_after(const std::string& data, model::Table& table) {
  model::TextColumn run = table.run();
  for (std::string& value : run.values) value = fmt::format("{}/{}", data, value);
  table.set_run(std::move(run));
}

}  // namespace

std::optional<RunInStore> run_in_store(const std::string& data, const DataOptions& options) {
  if (const auto run = run_number(data)) return RunInStore{options.store, *run};
  const std::size_t hash = data.rfind('#');
  if (hash == std::string::npos || hash == 0) return {};
  const auto run = run_number(std::string_view(data).substr(hash + 1));
  if (!run) return {};
  return RunInStore{data.substr(0, hash), *run};
}

void add_data_options(CLI::App& command, DataOptions& options, DataCount count) {
  CLI::Option* data =
      command
          .add_option("DATA", options.data,
                      "Measurements: the number of a run, STORE.db#NUMBER, or a CSV file")
          ->required();
  if (count == DataCount::kOne) data->expected(1);
  command
      .add_option("--column", options.columns,
                  "wanted=name: take this column from one of another name")
      ->allow_extra_args(false);
  command
      .add_option("--unit", options.units,
                  "name=unit: what this column of the file is in, such as gyro=deg/s; it is taken "
                  "to the unit that the wanted name ends in")
      ->allow_extra_args(false);
  command.add_option("--segment", options.segment,
                     "Only rows whose segment matches, such as 'coil_z/*'");
  command.add_flag("--unfinished", options.unfinished,
                   "Take runs that were interrupted, aborted or failed too");
  add_store_option(command, options.store);
}

std::string data_name(const DataOptions& options) {
  std::vector<std::string> names;
  for (const std::string& data : options.data) {
    names.push_back(run_number(data) ? "run " + data : data);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string data_arguments(const DataOptions& options) {
  std::string out;
  for (const std::string& data : options.data) out += " " + shell_word(data);
  for (const std::string& column : options.columns) out += " --column " + shell_word(column);
  for (const std::string& unit : options.units) out += " --unit " + shell_word(unit);
  if (!options.segment.empty()) out += " --segment " + shell_word(options.segment);
  if (options.unfinished) out += " --unfinished";
  out += store_argument(options.store);
  return out.substr(out.empty() ? 0 : 1);
}

std::string command_with_adequate(const DataOptions& options, const std::string& model,
                                  bool fitted) {
  const bool use = fitted && options.data.size() == 1;  // what compensate takes
  return fmt::format("fogbench {} {} --model {} -o {}", use ? "compensate" : "fit",
                     data_arguments(options), shell_word(model),
                     use ? "compensated.csv" : "fitted.json");
}

Result<model::Table> load_table(const DataOptions& options, std::size_t most_rows) {
  const auto renames =
      parse_pairs(options.columns, "--column", "wanted=name, such as rate_deg_per_h=omega,");
  if (!renames) return renames.error();
  const auto units = parse_pairs(options.units, "--unit", "name=unit, such as gyro=deg/s,");
  if (!units) return units.error();
  std::optional<model::Table> all;
  for (const std::string& data : options.data) {
    auto table = load_one(data, options, *renames, *units, most_rows);
    if (!table) return table.error();
    if (options.data.size() > 1) name_runs_after(data, *table);
    if (all) {
      all->append(*table);
    } else {
      all = std::move(*table);
    }
  }
  if (!all) return Error{ErrorCode::kUsage, "no measurements were named"};
  if (options.segment.empty()) return std::move(*all);

  std::vector<bool> matches;
  for (const std::string& segment : all->segment().values) {
    matches.push_back(fnmatch(options.segment.c_str(), segment.c_str(), 0) == 0);
  }
  std::vector<bool> keep(all->rows());
  for (std::size_t row = 0; row < keep.size(); ++row) {
    keep[row] = matches[all->segment().index[row]];
  }
  if (std::find(keep.begin(), keep.end(), true) == keep.end()) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("no row's segment matches {}; the segments are {}", options.segment,
                             fmt::join(all->segment().values, ", "))};
  }
  return all->select(keep);
}

}  // namespace fogbench::cli
