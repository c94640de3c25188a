// fogbench compare: a model against its measurements: the fit, where it fails
// and by how much, and what changed between runs.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/command.hpp"
#include "cli/compare_pair.hpp"
#include "cli/load_table.hpp"
#include "cli/noise_option.hpp"
#include "cli/output.hpp"
#include "cli/page_file.hpp"
#include "cli/shell_word.hpp"
#include "config/noise_parts.hpp"
#include "config/paths.hpp"
#include "config/rounding.hpp"
#include "config/units.hpp"
#include "model/compare/compare.hpp"
#include "model/report/report.hpp"
#include "model/table/row_order.hpp"

namespace fogbench::cli {
namespace {

struct CompareOptions {
  DataOptions data;
  std::string model;
  std::string weight_by;
  std::string report;
  std::string noise;
  bool as_is = false;
  bool check = false;
  bool json = false;
};

/// What to type next, as a shell takes it.
std::string next_step(const model::Comparison& c, const CompareOptions& options, bool fitted) {
  const std::string named =
      fmt::format("{} --model {}", data_arguments(options.data), shell_word(options.model));
  if (c.as_is) return fmt::format("fogbench compare {}   # fits the coefficients first", named);
  if (c.p_adequate < model::kAdequate) {
    return fmt::format("fogbench diagnose {}   # says which effect is missing", named);
  }
  return command_with_adequate(options.data, options.model, fitted);
}

/// The worst ranges; those that the fit leaves no freedom are not worth a line.
void print_ranges(const model::Comparison& c, std::string_view unit) {
  const std::string in(unit);
  std::vector<TextTable::Column> columns{{"range", "", TextTable::Align::kLeft},
                                         {"rows", ""},
                                         {"measured", in},
                                         {"model", in},
                                         {"residual", in}};
  const bool offsets = !c.regions.empty() && c.regions.front().drift_allowed;
  if (offsets) columns.push_back({"less drift", in});
  if (c.noise_known) columns.insert(columns.end(), {{"z", ""}, {"p of all", ""}});
  TextTable table(columns);
  constexpr std::size_t kMostRanges = 12;
  std::size_t shown = 0, left = 0;
  for (const model::Region& r : c.regions) {
    if (c.noise_known && r.z == 0.0) continue;
    if (shown == kMostRanges) {
      ++left;
      continue;
    }
    ++shown;
    std::vector<std::string> cells{
        model::place_of(r), std::to_string(r.rows), config::significant(r.observed, 4),
        config::significant(r.observed - r.residual, 4), config::significant(r.residual, 3)};
    if (offsets) cells.push_back(config::significant(r.offset, 3));
    if (c.noise_known) {
      cells.push_back(fmt::format("{:.1f}", r.z));
      cells.push_back(r.p_family_wise < 1e-4 ? "< 0.0001" : fmt::format("{:.2g}", r.p_family_wise));
    }
    table.add_row(std::move(cells));
  }
  if (table.empty()) return;
  fmt::print("{}", table.text());
  if (left > 0) fmt::print("and {} more ranges, all less far off\n", left);
  fmt::print("\n");
}

void print_text(const model::Comparison& c, const CompareOptions& options,
                const config::ModelFile& model) {
  const std::string_view unit = config::unit_of(model.observable);
  using Align = TextTable::Align;
  TextTable table({{"term", "", Align::kLeft},
                   {"estimate", ""},
                   {"+-", "95.45 %"},
                   {"unit", "", Align::kLeft}});
  for (const model::Estimate& e : c.fit.estimates) {
    if (!e.unexcited.empty()) {
      table.add_row({e.name, "not excited", "-", e.unit});
      continue;
    }
    const double expanded = e.coverage_factor * e.standard_error;
    const config::Rounded r = config::rounded(e.value, e.held ? 0.0 : expanded);
    table.add_row({e.name, r.value, e.held ? "held" : r.uncertainty, e.unit});
  }
  constexpr std::size_t kLead = 2;  // the verdict, and what carries it
  for (std::size_t i = 0; i < kLead; ++i) fmt::print("{}\n", c.sentences[i]);
  fmt::print("Next: {}\n\n{}\n", next_step(c, options, model.fit.has_value()), table.text());
  for (const std::string& warning : c.fit.warnings) fmt::print("warning: {}\n", warning);
  print_ranges(c, unit);
  for (std::size_t i = kLead; i < c.sentences.size(); ++i) fmt::print("{}\n", c.sentences[i]);
  if (!options.report.empty()) fmt::print("\nReport: {}\n", options.report);
}

nlohmann::json to_json(const model::Comparison& c, const CompareOptions& options, bool fitted) {
  nlohmann::json estimates = nlohmann::json::array(), regions = nlohmann::json::array(),
                 changes = nlohmann::json::array();
  for (const model::Estimate& e : c.fit.estimates) {
    estimates.push_back({{"name", e.name},
                         {"unit", e.unit},
                         {"value", e.value},
                         {"standard_error", e.standard_error},
                         {"expanded_uncertainty", e.coverage_factor * e.standard_error},
                         {"held", e.held},
                         {"excited", e.unexcited.empty()}});
  }
  for (const model::Region& r : c.regions) {
    regions.push_back({{"where", r.where},
                       {"variable", r.variable},
                       {"range", {r.from, r.to}},
                       {"rows", r.rows},
                       {"observed_deg_per_h", r.observed},
                       {"model_deg_per_h", r.observed - r.residual},
                       {"residual_deg_per_h", r.residual},
                       {"offset_deg_per_h", r.offset},
                       {"standard_error_deg_per_h", r.standard_error},
                       {"z", r.z},
                       {"p_family_wise", r.p_family_wise},
                       {"says", r.says}});
  }
  for (const model::RunChange& change : c.changes) {
    changes.push_back({{"run_a", change.run_a},
                       {"run_b", change.run_b},
                       {"common_scale", change.common_scale},
                       {"scale_standard_error", change.scale_standard_error},
                       {"angle_deg", change.angle_deg},
                       {"p_repeat", change.p_repeat},
                       {"scale_changed", change.scale_changed},
                       {"says", change.says}});
  }
  nlohmann::json left_out = nlohmann::json::array();
  for (const model::LeftOut& row : c.fit.left_out) {
    left_out.push_back({{"row", row.row + 1},
                        {"off_deg_per_h", row.off},
                        {"sigmas", row.sigmas},
                        {"says", row.says}});
  }
  nlohmann::json noise = config::noise_json(c.fit.noise.noise);
  noise["coloured"] = c.fit.coloured;
  noise["says"] = c.fit.noise.says;
  return {{"adequate", c.p_adequate >= model::kAdequate},
          {"p_adequate", c.p_adequate},
          {"looks_like", c.looks_like},
          {"noise_known", c.noise_known},
          {"as_is", c.as_is},
          {"fit",
           {{"rms_deg_per_h", c.fit.rms},
            {"noise_floor_deg_per_h", c.noise_floor},
            {"white_floor_deg_per_h", c.floor.white},
            {"noise_floor_5_95_deg_per_h", {c.floor.low, c.floor.high}},
            {"rows", c.fit.rows.size()}}},
          {"noise", noise},
          {"estimates", estimates},
          {"regions", regions},
          {"changes", changes},
          {"left_out", left_out},
          {"warnings", c.fit.warnings},
          {"sentences", c.sentences},
          {"next", next_step(c, options, fitted)}};
}

Result<ExitStatus> run_compare(const CompareOptions& options) {
  if (options.data.data.size() == 2) {
    if (options.as_is) {
      return Error{ErrorCode::kUsage, "--as-is holds a model against one DATA, found two"};
    }
    return compare_pair({options.data, options.model, options.weight_by, options.noise,
                         options.report, options.check, options.json});
  }
  if (options.model.empty()) {
    return Error{ErrorCode::kUsage,
                 "--model is required, or a second DATA to compare with the first (see fogbench "
                 "compare --help)"};
  }
  const auto file = config::find_config("models", options.model);
  if (!file) return file.error();
  const auto model = config::load_model(*file);
  if (!model) return model.error();
  // Whether the page can be written is better known before the work.
  std::optional<PageFile> page;
  if (!options.report.empty()) {
    auto opened = PageFile::open(options.report);
    if (!opened) return opened.error();
    page = std::move(*opened);
  }
  auto table = load_table(options.data, {&*model});
  if (!table) return table.error();
  const std::vector<std::string> notes = model::mend_stamps(*table, model->observable);
  const auto noise = chosen_noise(options.noise, options.data);
  if (!noise) return noise.error();
  const auto result = model::compare(*table, *model,
                                     {.noise = noise->kind,
                                      .weight_by = options.weight_by,
                                      .as_is = options.as_is,
                                      .prior = noise->prior});
  if (!result) return with_notes(result.error(), notes);
  for (const std::string& note : notes) print_note(note);
  if (page) {
    const Status written =
        page->write(model::report_html(*result, *table, *model, data_name(options.data)));
    if (!written) return written.error();
  }
  if (options.json) {
    nlohmann::json document = to_json(*result, options, model->fit.has_value());
    document["read_as"] = table->provenance();
    print_json(document);
  } else {
    print_text(*result, options, *model);
  }
  const bool no = options.check && result->p_adequate < model::kAdequate;
  return no ? ExitStatus::kNo : ExitStatus::kDone;
}

}  // namespace

void add_compare(CLI::App& app, Action& action) {
  add_command<CompareOptions>(
      app, action, "compare",
      "See where a model and its measurements differ, or two measurements from each other",
      "  fogbench compare config/data/paper-thermal.csv --model paper-thermal "
      "--as-is\n"
      "  fogbench compare 7 --model general --report page.html\n"
      "  fogbench compare 7 8                 # two runs, of one gyro or two\n"
      "  fogbench compare 7/1 7/2             # two tests of one run\n"
      "Two DATA are fitted each by itself and compared coefficient by coefficient.\n",
      [](CLI::App& command, CompareOptions& options) {
        add_data_options(command, options.data, DataCount::kOneOrTwo);
        command.add_option("--model", options.model,
                           "Model file, or a ready model's name (of two runs by default the ready "
                           "one of what they excited)");
        command.add_flag("--as-is", options.as_is,
                         "Hold the coefficients as given instead of fitting them");
        command.add_option("--weight-by", options.weight_by, "Column of standard deviations");
        add_noise_option(command, options.noise);
        command.add_option(
            "--report", options.report,
            "Write one self-contained HTML page, or its print when the name ends with .pdf");
        command.add_flag("--check", options.check,
                         "Exit with 1 when the model is inadequate, or two DATA differ");
        command.add_flag("--json", options.json, "One JSON document");
      },
      run_compare);
}

}  // namespace fogbench::cli
