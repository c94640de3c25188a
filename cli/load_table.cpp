#include "cli/load_table.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "acceptance/run_table.hpp"
#include "cli/common_options.hpp"
#include "cli/output.hpp"
#include "cli/shell_word.hpp"
#include "model/table/choose_columns.hpp"
#include "model/table/doubts.hpp"
#include "model/table/read_table.hpp"
#include "record/export.hpp"
#include "record/run_log_reader.hpp"

namespace fogbench::cli {
namespace {

using Pairs = std::map<std::string, std::string>;

/// "run 7", "test 2 of run 7", or the file.
std::string spoken(const std::string& data, const DataOptions& options) {
  const auto stored = run_in_store(data, options);
  if (!stored || stored->store != options.store) return data;
  const std::string run = fmt::format("run {}", stored->run);
  return stored->test.empty() ? run : fmt::format("test {} of {}", stored->test, run);
}

/// Rows of these tests.
Result<model::Table> only_tests(const std::string& data, const std::vector<std::string>& tests,
                                const model::Table& table) {
  std::vector<bool> keep(table.rows());
  for (std::size_t row = 0; row < keep.size(); ++row) {
    keep[row] = std::find(tests.begin(), tests.end(), table.run().at(row)) != tests.end();
  }
  if (std::find(keep.begin(), keep.end(), true) != keep.end()) return table.select(keep);
  return Error{ErrorCode::kBadInput,
               fmt::format("{}: has no test {}, expected one of {}", data, fmt::join(tests, " or "),
                           fmt::join(table.run().values, ", "))};
}

std::optional<std::int64_t> run_number(std::string_view text) {
  std::int64_t run = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), run);
  if (error != std::errc{} || end != text.data() + text.size() || run < 1) return {};
  return run;
}

Result<Pairs> parse_pairs(const std::vector<std::string>& given, const char* option,
                          const char* expected) {
  Pairs pairs;
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

/// The names that a model's terms ask for.
std::set<std::string> names_in(const config::ModelFile& model) {
  std::set<std::string> names{model.observable};
  const auto is_letter = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  };
  for (const config::ModelTerm& term : model.terms) {
    std::string name;
    for (const char c : term.effect + " " + term.expression.value_or("") + " ") {
      if (is_letter(c)) {
        name += c;
      } else if (!name.empty()) {
        names.insert(std::exchange(name, {}));
      }
    }
  }
  return names;
}

/// Columns of a run under another name or from another unit.
Status rename_in_run(std::int64_t run, const model::ReadOptions& read, model::Table& table) {
  std::vector<model::SourceColumn> source;
  for (const std::string& name : table.column_names()) source.push_back({name, {}});
  const auto choice = model::choose_columns(source, read);
  if (!choice) {
    return Error{choice.error().code, fmt::format("run {}: {}", run, choice.error().message)};
  }
  for (std::size_t i = 0; i < source.size(); ++i) {
    const model::ChosenColumn& chosen = choice->columns[i];
    const bool changes = chosen.is_foreign || read.units.contains(source[i].name);
    if (chosen.name.empty() || !changes) continue;
    const auto values = table.column(source[i].name);
    std::vector<double> converted(values.begin(), values.end());
    model::convert(chosen, converted);
    table.set_column(chosen.name, std::move(converted));
  }
  for (const std::string& line : choice->says) table.add_provenance(line);
  return {};
}

Result<std::unique_ptr<record::RunLogReader>> reader_of(const std::string& store) {
  const auto path = store_to_read(store);
  if (!path) return path.error();
  return record::RunLogReader::open(*path);
}

Result<model::Table> load_run(const RunInStore& stored, const DataOptions& options,
                              const model::ReadOptions& read) {
  const auto reader = reader_of(stored.store);
  if (!reader) return reader.error();
  const auto points = record::valid_points(**reader, stored.run, options.unfinished);
  if (!points) return points.error();
  const auto info = (*reader)->run(stored.run);
  if (!info) return info.error();
  if (!info->completed()) {
    print_note(fmt::format("run {} was not completed ({})", stored.run, info->outcome()));
  }
  model::Table table = acceptance::to_table(*points);
  if (Status renamed = rename_in_run(stored.run, read, table); !renamed) return renamed.error();
  return table;
}

Result<model::Table> load_file(const std::string& data, const model::ReadOptions& read) {
  const std::string file = file_of(data);
  return model::read_table(file, read, file == data ? "" : data.substr(file.size() + 1));
}

/// A test that was named as "7/1" is called so already.
void name_runs_after(const std::string& data, const DataOptions& options, model::Table& table) {
  const auto stored = run_in_store(data, options);
  const bool named = stored && !stored->test.empty();
  model::TextColumn run = table.run();
  for (std::string& value : run.values) value = named ? data : fmt::format("{}/{}", data, value);
  table.set_run(std::move(run));
}

}  // namespace

std::optional<RunInStore> run_in_store(const std::string& data, const DataOptions& options) {
  const std::size_t hash = data.rfind('#');
  const bool other = hash != std::string::npos && hash > 0;
  std::string_view number = std::string_view(data).substr(other ? hash + 1 : 0);
  std::string test;
  if (const std::size_t slash = number.find('/'); slash != std::string_view::npos) {
    test = number.substr(slash + 1);
    if (!run_number(test)) return {};
    number = number.substr(0, slash);
  }
  const auto run = run_number(number);
  if (!run) return {};
  return RunInStore{other ? data.substr(0, hash) : options.store, *run, std::move(test)};
}

Result<std::string> gyro_of(const std::string& data, const DataOptions& options) {
  const auto stored = run_in_store(data, options);
  if (!stored) return std::string();
  const auto reader = reader_of(stored->store);
  if (!reader) return reader.error();
  const auto run = (*reader)->run(stored->run);
  if (!run) return run.error();
  return run->header.gyro_serial_number;
}

Status expect_one_gyro(const std::vector<std::string>& data, const DataOptions& options) {
  if (options.several_gyros) return {};
  std::string first, first_gyro;
  for (const std::string& one : data) {
    const auto gyro = gyro_of(one, options);
    if (!gyro) return gyro.error();
    if (gyro->empty() || *gyro == first_gyro) continue;
    if (first_gyro.empty()) {
      first = one;
      first_gyro = *gyro;
      continue;
    }
    return Error{
        ErrorCode::kBadInput,
        fmt::format("{} is of gyro {} and {} of gyro {}; fogbench compare {} {} holds them "
                    "against each other, --several-gyros takes them for one",
                    spoken(first, options), first_gyro, spoken(one, options), *gyro,
                    shell_word(first), shell_word(one))};
  }
  return {};
}

std::string file_of(const std::string& data) {
  const std::size_t hash = data.rfind('#');
  std::error_code ignored;
  // A file may also have such a name.
  const bool whole =
      hash == std::string::npos || hash == 0 || std::filesystem::exists(data, ignored);
  return whole ? data : data.substr(0, hash);
}

void add_data_options(CLI::App& command, DataOptions& options, DataCount count) {
  CLI::Option* data =
      command
          .add_option("DATA", options.data,
                      "Measurements: the number of a run, 7/1 for test 1 of run 7, "
                      "STORE.db#NUMBER, or a file with a table: "
                      "text of any dialect (.gz, .zst too), MATLAB, HDF5; FILE#NAME for one of "
                      "several in it")
          ->required();
  if (count == DataCount::kOne) data->expected(1);
  if (count == DataCount::kOneOrTwo) data->expected(1, 2);
  if (count == DataCount::kSeveral) {
    command.add_flag("--several-gyros", options.several_gyros,
                     "Take runs of several gyros for those of one");
  }
  command
      .add_option("--column", options.columns,
                  "wanted=name: take this column from one of another name")
      ->allow_extra_args(false);
  command
      .add_option("--unit", options.units,
                  "name=unit: what this column of the file is in, such as gyro=deg/s; it is taken "
                  "to the unit that the wanted name ends in")
      ->allow_extra_args(false);
  command.add_option("--test", options.tests, "Only this test of each run")
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
    names.push_back(spoken(data, options));
  }
  if (options.tests.size() == 1) names.back() += ", test " + options.tests.front();
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string data_arguments(const DataOptions& options) {
  std::string out;
  for (const std::string& data : options.data) out += " " + shell_word(data);
  for (const std::string& column : options.columns) out += " --column " + shell_word(column);
  for (const std::string& unit : options.units) out += " --unit " + shell_word(unit);
  for (const std::string& test : options.tests) out += " --test " + shell_word(test);
  if (options.several_gyros) out += " --several-gyros";
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

Result<model::Table> load_one(const std::string& data, const DataOptions& options,
                              const LoadHow& how) {
  auto columns =
      parse_pairs(options.columns, "--column", "wanted=name, such as rate_deg_per_h=omega,");
  if (!columns) return columns.error();
  auto units = parse_pairs(options.units, "--unit", "name=unit, such as gyro=deg/s,");
  if (!units) return units.error();
  const model::ReadOptions read{std::move(*columns), std::move(*units),
                                how.model ? names_in(*how.model) : std::set<std::string>(),
                                how.need_all, how.most_rows};
  const auto stored = run_in_store(data, options);
  auto table = stored ? load_run(*stored, options, read) : load_file(data, read);
  if (!table) return table;
  if (stored && !stored->test.empty()) table = only_tests(data, {stored->test}, *table);
  if (table && !options.tests.empty()) table = only_tests(data, options.tests, *table);
  if (!table) return table;
  for (const std::string& line : table->provenance()) {
    note_beside_result(data + ": read as " + line);
  }
  for (const std::string& doubt : model::doubts(*table)) {
    note_beside_result(fmt::format("{}: warning: {}", data, doubt));
    table->add_provenance("warning: " + doubt);
  }
  return table;
}

Result<model::Table> load_table(const DataOptions& options, const LoadHow& how) {
  if (const Status one = expect_one_gyro(options.data, options); !one) return one.error();
  std::optional<model::Table> all;
  for (const std::string& data : options.data) {
    auto table = load_one(data, options, how);
    if (!table) return table.error();
    if (options.data.size() > 1) name_runs_after(data, options, *table);
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
