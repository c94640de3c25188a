#include "procedures/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/common_options.hpp"
#include "cli/output.hpp"
#include "daemon/session.hpp"
#include "procedures/phases.hpp"
#include "procedures/planned_points.hpp"
#include "procedures/sentence.hpp"

namespace fogbench::cli {
namespace {

struct PlanOptions {
  ProcedureOptions procedure;
  bool steps = false;
  bool json = false;
};

nlohmann::ordered_json to_json(const procedures::Plan& plan, const std::string& bench) {
  nlohmann::ordered_json document{{"procedure", plan.procedure},
                                  {"bench", bench},
                                  {"estimate_s", plan.estimate.count()},
                                  {"points", procedures::planned_points(plan)},
                                  {"limits_met", plan.limits_met},
                                  {"phases", nlohmann::ordered_json::array()},
                                  {"steps", nlohmann::ordered_json::array()}};
  for (const auto& phase : procedures::phases_of(plan)) {
    document["phases"].push_back({{"says", phase.says},
                                  {"starts_after_s", phase.starts_after.count()},
                                  {"estimate_s", phase.estimate.count()},
                                  {"steps", phase.steps},
                                  {"points", phase.points},
                                  {"more_points", phase.open}});
  }
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

/// "82", "-" for none, "3+" where there are more on the way to a temperature.
std::string planned_count(std::size_t points, bool open) {
  if (points == 0 && !open) return "-";
  return fmt::format("{}{}", points, open ? "+" : "");
}

TextTable plan_table(const char* first) {
  using Align = TextTable::Align;
  return TextTable({{first, "", Align::kLeft},
                    {"starts after", ""},
                    {"takes", ""},
                    {"points", ""},
                    {"what", "", Align::kLeft}});
}

TextTable table_of_phases(const procedures::Plan& plan) {
  TextTable table = plan_table("phase");
  std::size_t number = 0;
  for (const auto& phase : procedures::phases_of(plan)) {
    table.add_row({std::to_string(++number), procedures::duration_text(phase.starts_after),
                   procedures::duration_text(phase.estimate),
                   planned_count(phase.points, phase.open), phase.says});
  }
  return table;
}

TextTable table_of_steps(const procedures::Plan& plan) {
  TextTable table = plan_table("step");
  config::Seconds elapsed{0.0};
  for (const auto& step : plan.steps) {
    table.add_row(
        {step.path, procedures::duration_text(elapsed), procedures::duration_text(step.estimate),
         planned_count(procedures::planned_points(step), procedures::is_open(step)), step.says});
    elapsed += step.estimate;
  }
  return table;
}

void print_plan(const procedures::Plan& plan, const std::string& bench, bool steps) {
  fmt::print("{}", wrapped(fmt::format("{} on bench {}: {}", plan.procedure, bench,
                                       procedures::summary_text(plan)),
                           ""));
  const TextTable table = steps ? table_of_steps(plan) : table_of_phases(plan);
  fmt::print("\n{}\nLimits met\n", table.text(kTextWidth));
  for (const std::string& sentence : plan.limits_met) fmt::print("{}", wrapped(sentence, "  "));
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
    print_plan(planned->plan, setup->bench.name, options.steps);
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_plan(CLI::App& app, Action& action) {
  add_command<PlanOptions>(
      app, action, "plan", "Say what a procedure will do and how long it takes; touches nothing",
      "  fogbench plan acceptance\n"
      "  fogbench plan acceptance --steps\n"
      "  fogbench plan coil-sweep --bench my-bench.json --set average_s=60",
      [](CLI::App& command, PlanOptions& options) {
        add_procedure_options(command, options.procedure);
        command.add_flag("--steps", options.steps, "Every step, and not its phases");
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_plan);
}

}  // namespace fogbench::cli
