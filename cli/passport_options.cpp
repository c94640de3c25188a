#include "cli/passport_options.hpp"

#include <fmt/format.h>

#include <charconv>

#include "cli/common_options.hpp"
#include "config/paths.hpp"
#include "drivers/clock.hpp"

namespace fogbench::cli {
namespace {

Result<std::vector<std::int64_t>> run_numbers(const std::vector<std::string>& texts) {
  std::vector<std::int64_t> runs;
  for (const std::string& text : texts) {
    std::int64_t run = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), run);
    if (error != std::errc{} || end != text.data() + text.size() || run < 1) {
      return Error{ErrorCode::kUsage,
                   fmt::format("RUN: the number of a run was expected, not {}", text)};
    }
    runs.push_back(run);
  }
  return runs;
}

}  // namespace

void add_passport_options(CLI::App& command, PassportOptions& options) {
  command
      .add_option(
          "RUN", options.runs,
          "Numbers of the gyro's runs (fogbench runs lists them): an acceptance, or several")
      ->required();
  command.add_option("--limits", options.limits,
                     "A limits file, or a ready one (default: acceptance)");
  command.add_option("--model", options.model,
                     "Error model to fit to each test (default: thermal, magnetic or general, by "
                     "what the test excited)");
  command.add_flag("--unfinished", options.unfinished,
                   "Take runs that were interrupted, aborted or failed too; they never pass");
  add_store_option(command, options.store);
}

Result<acceptance::Passport> judge_runs(const PassportOptions& options) {
  const auto runs = run_numbers(options.runs);
  if (!runs) return runs.error();
  const auto limits_file = config::find_config("limits", options.limits);
  if (!limits_file) return limits_file.error();
  auto limits = config::load_limits(*limits_file);
  if (!limits) return limits.error();
  acceptance::AcceptanceOptions how{.model = {}, .unfinished = options.unfinished};
  if (!options.model.empty()) {
    const auto file = config::find_config("models", options.model);
    if (!file) return file.error();
    auto model = config::load_model(*file);
    if (!model) return model.error();
    how.model = std::move(*model);
  }
  const auto path = store_to_read(options.store);
  if (!path) return path.error();
  auto reader = record::RunLogReader::open(*path);
  if (!reader) return reader.error();
  auto acceptance = acceptance::gather_acceptance(**reader, *runs, how);
  if (!acceptance) return acceptance.error();
  return acceptance::make_passport(std::move(*acceptance), std::move(*limits),
                                   drivers::utc_text(drivers::SteadyClock().wall_now()),
                                   FOGBENCH_VERSION);
}

}  // namespace fogbench::cli
