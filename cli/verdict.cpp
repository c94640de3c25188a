// fogbench verdict: the results of a gyro's runs against its limits.

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "acceptance/conditions.hpp"
#include "acceptance/passport_json.hpp"
#include "cli/command.hpp"
#include "cli/common_options.hpp"
#include "cli/output.hpp"
#include "cli/passport_options.hpp"
#include "cli/shell_word.hpp"
#include "config/rounding.hpp"

namespace fogbench::cli {
namespace {

struct VerdictOptions {
  PassportOptions passport;
  bool json = false;
};

std::string limit_text(const std::optional<double>& limit) {
  return limit ? fmt::format("{:g}", *limit) : "";
}

std::string results_table(const model::Judged& judged) {
  using Align = TextTable::Align;
  TextTable table({{"quantity", "", Align::kLeft},
                   {"test", "", Align::kLeft},
                   {"value", ""},
                   {"+- U", ""},
                   {"minimum", ""},
                   {"maximum", ""},
                   {"unit", "", Align::kLeft},
                   {"measured at", "", Align::kLeft},
                   {"verdict", "", Align::kLeft}});
  for (const model::Judgement& r : judged.results) {
    const bool missing = r.test.empty();
    const config::Rounded number = config::rounded(r.value, r.expanded_uncertainty);
    const std::string verdict = missing ? fmt::format("indeterminate: measured in {} of {} tests",
                                                      r.tests_measured, r.tests_expected)
                                        : std::string(name_of(r.verdict));
    table.add_row({r.quantity, missing ? "-" : r.test, missing ? "missing" : number.value,
                   std::isfinite(r.expanded_uncertainty) ? number.uncertainty : "-",
                   limit_text(r.minimum), limit_text(r.maximum), r.unit,
                   acceptance::conditions_text(r.conditions, "degC", "uT"), verdict});
  }
  return table.text();
}

std::string repeats_table(const model::Judged& judged) {
  using Align = TextTable::Align;
  TextTable table({{"quantity", "", Align::kLeft},
                   {"tests", "", Align::kLeft},
                   {"difference", ""},
                   {"+- U", ""},
                   {"limit", ""},
                   {"unit", "", Align::kLeft},
                   {"verdict", "", Align::kLeft}});
  for (const model::Repeat& r : judged.repeats) {
    const bool missing = std::isnan(r.difference);
    const config::Rounded number = config::rounded(r.difference, r.expanded_uncertainty);
    table.add_row({r.quantity, missing ? "-" : fmt::format("{} to {}", r.test_a, r.test_b),
                   missing ? "missing" : number.value, missing ? "-" : number.uncertainty,
                   limit_text(r.limit), r.unit,
                   r.verdict       ? std::string(name_of(*r.verdict))
                   : r.significant ? "not limited; changed beyond U"
                                   : "not limited; within U"});
  }
  return table.empty() ? "" : "\nFrom test to test\n\n" + table.text();
}

void print_text(const acceptance::Passport& passport, const VerdictOptions& options) {
  const model::Judged& judged = passport.judged;
  fmt::print("{}: gyro {} against limits {}, U with k = {:g}\n\n{}{}", name_of(judged.overall),
             passport.acceptance.gyro(), passport.limits.name, judged.coverage_factor,
             results_table(judged), repeats_table(judged));
  for (const model::RunChange& change : passport.acceptance.changes) {
    fmt::print("\n{}\n", acceptance::change_text(change, judged.coverage_factor,
                                                 acceptance::Language::kEnglish));
  }
  if (!passport.remarks.empty()) fmt::print("\n");
  for (const acceptance::Remark& remark : passport.remarks) {
    fmt::print("remark: {}\n", acceptance::remark_text(remark, acceptance::Language::kEnglish));
  }
  std::string same;
  for (const std::string& run : options.passport.runs) same += " " + run;
  same += " --limits " + shell_word(options.passport.limits);
  if (!options.passport.model.empty()) same += " --model " + shell_word(options.passport.model);
  if (options.passport.unfinished) same += " --unfinished";
  same += store_argument(options.passport.store);
  fmt::print("\nNext: fogbench passport{} -o passport.html\n", same);
}

Result<ExitStatus> run_verdict(const VerdictOptions& options) {
  const auto passport = judge_runs(options.passport);
  if (!passport) return passport.error();
  if (options.json) {
    print_json(acceptance::verdict_json(*passport));
  } else {
    print_text(*passport, options);
  }
  return passport->judged.overall == model::Conformity::kPass ? ExitStatus::kDone : ExitStatus::kNo;
}

}  // namespace

void add_verdict(CLI::App& app, Action& action) {
  add_command<VerdictOptions>(
      app, action, "verdict", "Hold a gyro's results against its limits",
      "  fogbench verdict 7\n"
      "  fogbench verdict 7 8 --limits my-gyro.json --json\n"
      "A result passes when it is within its limits together with its expanded uncertainty. Exit "
      "status:\n0 pass, 1 fail or indeterminate.",
      [](CLI::App& command, VerdictOptions& options) {
        add_passport_options(command, options.passport);
        command.add_flag("--json", options.json, "One JSON document on stdout");
      },
      run_verdict);
}

}  // namespace fogbench::cli
