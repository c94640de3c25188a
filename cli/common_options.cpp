#include "cli/common_options.hpp"

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <system_error>

#include "cli/control_client.hpp"
#include "cli/output.hpp"
#include "cli/shell_word.hpp"
#include "config/column_unit.hpp"
#include "drivers/clock.hpp"
#include "record/store.hpp"

namespace fogbench::cli {
namespace {

/// kUsage-worthy when empty: not a finite number. Blanks around it are allowed.
std::optional<double> parse_number(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

bool is_span_option(std::string_view option) {
  return option == "--average" || option == "--tolerance";
}

bool is_unit_of_time(std::string_view text) {
  const config::StatedUnit* const unit = config::unit_spelt(text);
  return unit != nullptr && unit->dimension == config::Dimension::kTime;
}

Result<std::filesystem::path> unnamed_store() {
  const auto standard = record::default_store();
  const std::string served = served_store();
  if (served.empty() || (standard && *standard == served)) return standard;
  std::error_code error;
  if (standard && std::filesystem::exists(*standard, error)) {
    print_note(fmt::format("this is {}; the fogbenchd that serves here writes --store {}",
                           standard->string(), shell_word(served)));
    return standard;
  }
  print_note(fmt::format("this is {}, which the fogbenchd that serves here writes", served));
  return std::filesystem::path(served);
}

}  // namespace

void add_store_option(CLI::App& command, std::string& store) {
  command.add_option("--store", store,
                     "Run log to use (default: $FOGBENCH_STORE, else the user's own)");
}

Result<std::filesystem::path> store_path(const std::string& store) {
  if (store.empty()) return record::default_store();
  return std::filesystem::path(store);
}

Result<std::filesystem::path> store_to_read(const std::string& store) {
  const bool named = !store.empty() || std::getenv("FOGBENCH_STORE") != nullptr;  // NOLINT
  if (named) return store_path(store);
  static const auto kFound = unnamed_store();  // the note is one, however often a command reads
  return kFound;
}

std::string store_argument(const std::string& store) {
  return store.empty() ? "" : " --store " + shell_word(store);
}

std::string wrong_run_number(const std::string& text) {
  // strtoll, which reads the number, would take any that is too large for the largest.
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 0) {
    return "the number of a run was expected, not " + text;
  }
  return value > 0 ? "" : "there is no run 0: they are numbered from 1";
}

void add_run_option(CLI::App& command, std::int64_t& run) {
  command.add_option("RUN", run, "The run's number (fogbench runs lists them)")
      ->required()
      ->check(wrong_run_number);
}

void add_procedure_options(CLI::App& command, ProcedureOptions& options) {
  command
      .add_option("PROCEDURE", options.procedure,
                  "A procedure file, or a ready one: acceptance, coil-sweep, thermostat-steps...")
      ->required();
  command.add_option("--bench", options.bench, "A bench file, or a ready one (default: simulated)");
  command
      .add_option("--set", options.set,
                  "name=value or name=value,value...: a parameter of the procedure; blanks "
                  "after commas are allowed")
      ->allow_extra_args(false);
}

std::vector<std::string> arguments_with_lists(int argc, char** argv) {
  std::vector<std::string> joined;
  bool value = false;  // of --set
  for (int i = 1; i < argc; ++i) {
    const std::string_view text = argv[i];
    if (joined.size() > 1 && is_span_option(*std::prev(joined.end(), 2)) &&
        parse_number(joined.back()) && is_unit_of_time(text)) {
      joined.back() += fmt::format(" {}", text);
      continue;
    }
    const bool unfinished = value && (joined.back().ends_with(',') || joined.back().ends_with('='));
    if (unfinished || (value && text.starts_with(','))) {
      joined.back() += text;
      continue;
    }
    value = text.starts_with("--set=") || (i > 1 && std::string_view(argv[i - 1]) == "--set");
    joined.emplace_back(text);
  }
  return joined;
}

Result<daemon::Parameters> parse_parameters(const std::vector<std::string>& set) {
  daemon::Parameters parameters;
  for (const std::string& assignment : set) {
    const Error error{
        ErrorCode::kUsage,
        fmt::format("--set {}: name=number or name=number,number... was expected", assignment)};
    const std::size_t equals = assignment.find('=');
    if (equals == 0 || equals == std::string::npos) return error;
    const std::string name = assignment.substr(0, equals);
    if (parameters.contains(name)) {
      return Error{ErrorCode::kUsage,
                   fmt::format("--set {}: {} is set twice, once was expected", assignment, name)};
    }
    std::string_view rest = std::string_view(assignment).substr(equals + 1);
    std::vector<double> values;
    while (true) {
      const std::size_t comma = std::min(rest.find(','), rest.size());
      const auto value = parse_number(rest.substr(0, comma));
      if (!value) return error;
      values.push_back(*value);
      if (comma == rest.size()) break;
      rest.remove_prefix(comma + 1);
    }
    if (values.size() == 1) {
      parameters[name] = values.front();
    } else {
      parameters[name] = std::move(values);
    }
  }
  return parameters;
}

CLI::Option* add_gyro_on_since_option(CLI::App& command, std::string& moment) {
  return command.add_option(
      "--gyro-on-since", moment,
      "When the gyro was switched on: 2026-11-29T18:00:00Z, or so long ago, 40min (default: when "
      "its stream was first heard)");
}

Result<double> parse_moment(const std::string& option, const std::string& text) {
  const double day = drivers::seconds_of_utc(text + "T00:00:00Z");
  const double instant = drivers::seconds_of_utc(text);
  if (std::isfinite(day)) return day;
  if (std::isfinite(instant)) return instant;
  double count = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  const std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  const double unit_s = unit == "min" ? 60.0 : unit == "h" ? 3600.0 : unit == "d" ? 86400.0 : 0.0;
  if (error != std::errc{} || unit_s == 0.0 || !(count >= 0.0)) {
    return Error{ErrorCode::kUsage,
                 fmt::format("{}: found \"{}\", expected a date (2026-11-29), a time "
                             "(2026-11-29T18:00:00Z), or so long ago (40min, 12h, 7d)",
                             option, text)};
  }
  const std::chrono::duration<double> now =
      drivers::SteadyClock::system_calendar().time_since_epoch();
  return now.count() - count * unit_s;
}

}  // namespace fogbench::cli
