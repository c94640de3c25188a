#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <variant>

#include "cli/command.hpp"
#include "cli/common_options.hpp"
#include "cli/output.hpp"
#include "cli/progress_line.hpp"
#include "cli/run_report.hpp"
#include "config/model_file.hpp"
#include "config/paths.hpp"
#include "daemon/abort_on_signal.hpp"
#include "daemon/access.hpp"
#include "daemon/run_options.hpp"
#include "daemon/session.hpp"
#include "daemon/simulated_operator.hpp"
#include "procedures/sentence.hpp"

namespace fogbench::cli {
namespace {

using procedures::Point;
using procedures::RunOutcome;

struct DryRunOptions {
  ProcedureOptions procedure;
  std::string scenario = daemon::SetupOptions{}.scenario;
  std::optional<std::uint64_t> seed;
  std::string store;
  std::string operator_name, gyro;
  daemon::Speed speed = daemon::Speed::kMaximum;
  bool json = false;
};

void print_heading(const procedures::Plan& plan, const DryRunOptions& options,
                   const std::string& bench, std::uint64_t seed) {
  fmt::print("{}, dry run on bench {}: {} steps, about {} of bench time\n", plan.procedure, bench,
             plan.steps.size(), procedures::duration_text(plan.estimate));
  for (const std::string& sentence : plan.limits_met) fmt::print("{}", wrapped(sentence, "  "));
  fmt::print("scenario {}, seed {}\n\n", options.scenario, seed);
  fmt::print("{:>5}  {:>10}  {:<24}{:>9}{:>9}{:>11}  {:<10}\n", "point", "time, s", "segment",
             "T, degC", "H, uT", "deg/h", "+-");
}

/// The point is on disk already, and stays there when this line has been printed. False when
/// nobody can read it.
bool print_point(std::size_t number, const Point& point) {
  fmt::print("{:>5}  {:>10.1f}  {:<24}{:>9}{:>9}{:>11}  {}{}\n", number, point.time_s,
             point.segment, fixed(point.temperature_c, 2), fixed(point.field_set_ut, 0),
             fixed(point.rate_deg_per_h, 4), fixed(point.rate_std_error_deg_per_h, 4),
             point.dropped == 0 ? "" : fmt::format("  ({} frames dropped)", point.dropped));
  return std::fflush(stdout) == 0;
}

/// The ready model for what the plan excites.
const char* model_for(const procedures::Plan& plan) {
  const auto has = [&plan](auto is) {
    return std::any_of(plan.steps.begin(), plan.steps.end(),
                       [is](const auto& step) { return is(step.action); });
  };
  using procedures::Ramp, procedures::SettleTemperature, procedures::SweepLevel;
  const bool heated = has([](const auto& a) {
    return std::holds_alternative<SettleTemperature>(a) || std::holds_alternative<Ramp>(a);
  });
  const bool swept = has([](const auto& a) { return std::holds_alternative<SweepLevel>(a); });
  if (heated && swept) return "general";
  return swept ? "magnetic" : "thermal";
}

/// Whether there is a point for each of the model's terms.
bool can_be_fitted(const std::string& model, std::size_t points) {
  const auto file = config::find_config("models", model);
  if (!file) return false;
  const auto read = config::load_model(*file);
  return read && points >= read->terms.size();
}

Status print_results(const std::filesystem::path& store, const procedures::Plan& plan,
                     const procedures::RunSummary& summary, const DryRunOptions& options) {
  auto reader = record::RunLogReader::open(store);
  if (!reader) return reader.error();
  if (options.json) {
    auto document = run_json(**reader, summary.run);
    if (!document) return document.error();
    (*document)["store"] = store.string();
    print_json(*document);
    return {};
  }
  const auto results = results_text(**reader, summary.run);
  if (!results) return results.error();
  std::string named = store_argument(options.store);
  fmt::print("{}\nRun {} is in {}\n", *results, summary.run, store.string());
  const std::string show = fmt::format("fogbench show {}{}", summary.run, named);
  if (summary.points == 0) {
    fmt::print("Next: {}\n", show);
    return {};
  }
  if (summary.end.outcome != RunOutcome::kCompleted) named += " --unfinished";
  fmt::print("Next: fogbench verdict {0}{1}\n      fogbench passport {0}{1} -o passport-{0}.html\n",
             summary.run, named);
  fmt::print("      {}\n", show);
  fmt::print("      fogbench export {0}{1} -o run-{0}.csv\n", summary.run, named);
  const std::string model = model_for(plan);
  if (can_be_fitted(model, summary.points)) {
    fmt::print("      fogbench fit {0}{1} --model {2} -o run-{0}-{2}.json\n", summary.run, named,
               model);
  }
  return {};
}

Result<ExitStatus> run_dry_run(const DryRunOptions& options) {
  const auto parameters = parse_parameters(options.procedure.set);
  if (!parameters) return parameters.error();
  auto setup = daemon::load_setup({options.procedure.bench, options.scenario});
  if (!setup) return setup.error();
  const std::string bench = setup->bench.name;
  if (!options.gyro.empty()) setup->bench.gyro.serial_number = options.gyro;
  const auto planned =
      daemon::plan_procedure(options.procedure.procedure, setup->bench, *parameters);
  if (!planned) return planned.error();
  const auto store = store_path(options.store);
  if (!store) return store.error();
  const std::uint64_t seed = options.seed.value_or(daemon::random_seed());

  daemon::AbortOnSignal abort_on_signal;
  daemon::SimulatedOperator person;
  auto session = daemon::Session::open(std::move(*setup), seed, *store, options.speed, person);
  if (!session) return session.error();
  procedures::RunEngine& engine = (*session)->engine();
  abort_on_signal.attach(**session);
  if (!options.json) print_heading(planned->plan, options, bench, seed);
  std::fflush(stdout);

  ProgressLine progress;
  std::size_t points = 0;
  bool unread = false;
  engine.on_progress([&](const procedures::Progress& now) { progress.show(now); });
  engine.on_point([&](const Point& point) {
    ++points;
    if (options.json) return;
    progress.clear();
    if (print_point(points, point)) return;
    unread = true;
    engine.request_abort();
  });
  const std::string person_name =
      options.operator_name.empty() ? daemon::user_name(getuid()) : options.operator_name;
  const auto summary = (*session)->run(*planned, person_name);
  progress.clear();
  if (!summary) return summary.error();

  if (const Status printed = print_results(*store, planned->plan, *summary, options); !printed) {
    return printed.error();
  }
  if (summary->end.outcome == RunOutcome::kCompleted) return ExitStatus::kDone;
  return Error{
      summary->end.outcome == RunOutcome::kAborted ? ErrorCode::kAborted : ErrorCode::kDevice,
      fmt::format("run {} {}: {}; the bench is {}", summary->run,
                  summary->end.outcome == RunOutcome::kAborted ? "aborted" : "failed",
                  unread ? "its points could not be written to standard output"
                         : summary->end.reason.c_str(),
                  summary->end.safe_state_reached ? "in its safe state" : "NOT in its safe state")};
}

}  // namespace

void add_dry_run(CLI::App& app, Action& action) {
  add_command<DryRunOptions>(
      app, action, "dry-run", "Run a procedure on the simulated bench and log it",
      "  fogbench dry-run acceptance\n"
      "  fogbench dry-run coil-sweep --scenario hysteresis-z --seed 42 --store try.db\n"
      "The same procedure, bench, scenario and seed give the same measurements.",
      [](CLI::App& command, DryRunOptions& options) {
        add_procedure_options(command, options.procedure);
        command.add_option(
            "--scenario", options.scenario,
            "What the simulated gyro hides: a file, or a ready one (default: clean)");
        daemon::add_seed_option(command, options.seed);
        daemon::add_gyro_option(command, options.gyro);
        command.add_option("--operator", options.operator_name,
                           "Who runs it, for the record (default: the user's login name)");
        add_store_option(command, options.store);
        daemon::add_speed_option(command, options.speed, "max");
        command.add_flag("--json", options.json, "One JSON document on stdout, at the end");
      },
      run_dry_run);
}

}  // namespace fogbench::cli
