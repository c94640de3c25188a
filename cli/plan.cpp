#include "procedures/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <variant>

#include "cli/command.hpp"
#include "cli/common_options.hpp"
#include "cli/output.hpp"
#include "daemon/session.hpp"
#include "procedures/planned_points.hpp"
#include "procedures/sentence.hpp"

namespace fogbench::cli {
namespace {

struct PlanOptions {
  ProcedureOptions procedure;
  bool json = false;
};

nlohmann::ordered_json to_json(const procedures::Plan& plan, const std::string& bench) {
  nlohmann::ordered_json document{
      {"procedure", plan.procedure},         {"bench", bench},
      {"estimate_s", plan.estimate.count()}, {"points", procedures::planned_points(plan)},
      {"limits_met", plan.limits_met},       {"steps", nlohmann::ordered_json::array()}};
  for (const auto& step : plan.steps) {
    document["steps"].push_back({{"path", step.path},
                                 {"test", step.test},
                                 {"block", step.block},
                                 {"says", step.says},
                                 {"estimate_s", step.estimate.count()},
                                 {"points", procedures::planned_points(step)}});
  }
  return document;
}

/// "82 points, and what settling takes" of a plan that records on the way to a temperature.
std::string planned_text(const procedures::Plan& plan) {
  if (!procedures::measures(plan)) return "no points";
  const std::size_t points = procedures::planned_points(plan);
  const bool more = std::any_of(plan.steps.begin(), plan.steps.end(), [](const auto& step) {
    const auto* settle = std::get_if<procedures::SettleTemperature>(&step.action);
    return settle != nullptr && !settle->segment.empty();
  });
  return fmt::format("{} {}{}", points, points == 1 ? "point" : "points",
                     more ? " and those on the way to a temperature" : "");
}

void print_plan(const procedures::Plan& plan, const std::string& bench) {
  fmt::print("{} on bench {}: {} steps, about {}, {}\n\n", plan.procedure, bench, plan.steps.size(),
             procedures::duration_text(plan.estimate), planned_text(plan));
  using Align = TextTable::Align;
  TextTable table({{"step", "", Align::kLeft},
                   {"starts after", ""},
                   {"takes", ""},
                   {"what", "", Align::kLeft}});
  config::Seconds elapsed{0.0};
  for (const auto& step : plan.steps) {
    table.add_row({step.path, procedures::duration_text(elapsed),
                   procedures::duration_text(step.estimate), step.says});
    elapsed += step.estimate;
  }
  fmt::print("{}\nLimits met\n", table.text());
  for (const std::string& sentence : plan.limits_met) fmt::print("  {}\n", sentence);
}

Result<ExitStatus> run_plan(const PlanOptions& options) {
  const auto parameters = parse_parameters(options.procedure.set);
  if (!parameters) return parameters.error();
  const auto setup = daemon::load_setup({.bench = options.procedure.bench});
  if (!setup) return setup.error();
  const auto planned =
      daemon::plan_procedure(options.procedure.procedure, setup->bench, *parameters);
  if (!planned) return planned.error();
  if (options.json) {
    print_json(to_json(planned->plan, setup->bench.name));
  } else {
    print_plan(planned->plan, setup->bench.name);
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_plan(CLI::App& app, Action& action) {
  add_command<PlanOptions>(
      app, action, "plan", "Say what a procedure will do and how long it takes; touches nothing",
      "  fogbench plan acceptance\n"
      "  fogbench plan coil-sweep --bench my-bench.json --set average_s=60",
      [](CLI::App& command, PlanOptions& options) {
        add_procedure_options(command, options.procedure);
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_plan);
}

}  // namespace fogbench::cli
