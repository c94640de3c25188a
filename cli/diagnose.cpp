// fogbench diagnose: which effect a model lacks, how sure that is, or that nothing is missing.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/load_table.hpp"
#include "cli/output.hpp"
#include "config/output_file.hpp"
#include "config/paths.hpp"
#include "config/units.hpp"
#include "model/diagnose/diagnose.hpp"
#include "model/diagnose/diagnosis_report.hpp"

namespace fogbench::cli {
namespace {

using nlohmann::ordered_json;

struct DiagnoseOptions {
  DataOptions data;
  std::string model;
  std::string quiet;
  std::string report;
  std::vector<std::string> candidates;
  std::uint64_t seed = model::DiagnoseOptions{}.seed;
  bool check = false;
  bool json = false;
};

/// What to type next.
std::string next_step(const model::Diagnosis& d, const DiagnoseOptions& options) {
  const std::string data = fmt::format("{}", fmt::join(options.data.data, " "));
  if (d.missing.empty()) {
    return fmt::format("fogbench fit {} --model {} -o fitted.json", data, options.model);
  }
  std::vector<std::string> effects;
  for (const model::MissingEffect& m : d.missing) effects.push_back(m.found.effect);
  return fmt::format(
      "fogbench add {} --model {} -o wider.json && fogbench diagnose {} --model "
      "wider.json",
      fmt::join(effects, " "), options.model, data);
}

ordered_json missing_json(const model::MissingEffect& m) {
  ordered_json parameters = ordered_json::object(), coefficients = ordered_json::object(),
               errors = ordered_json::object(), rivals = ordered_json::array();
  for (const model::Estimate& e : m.estimates) {
    // "warm_up.tau" is an inner parameter, "earth_rate_projection.cos" a coefficient.
    const std::string suffix =
        e.name.starts_with(m.found.effect + ".") ? e.name.substr(m.found.effect.size() + 1) : "";
    (e.name == m.inner_name ? parameters[suffix] : coefficients[e.name]) = e.value;
    errors[e.name] = e.coverage_factor * e.standard_error;
  }
  for (const model::Rival& r : m.found.rivals) {
    rivals.push_back({{"effect", r.effect}, {"probability", r.probability}});
  }
  return {{"effect", m.found.effect},
          {"probability", m.found.probability},
          {"p_value", m.found.p_value},
          {"parameters", parameters},
          {"coefficients", coefficients},
          {"expanded_uncertainty", errors},
          {"identified", !m.found.inner_at_edge},
          {"rms_after", m.rms_after},
          {"heldout_rms_after", m.heldout_rms_after},
          {"or_shape", m.found.or_shape.empty() ? ordered_json() : ordered_json(m.found.or_shape)},
          {"rivals", rivals}};
}

ordered_json to_json(const model::Diagnosis& d, const DiagnoseOptions& options) {
  ordered_json failures = ordered_json::array(), missing = ordered_json::array(),
               not_testable = ordered_json::array(), bounds = ordered_json::array(),
               next = ordered_json::array(), ladder = ordered_json::array();
  for (const model::Region& r : d.before.regions) {
    if (!d.before.noise_known || r.p_family_wise > d.false_alarm_rate) continue;
    failures.push_back({{"where", r.where},
                        {"variable", r.variable},
                        {"range", {r.from, r.to}},
                        {"residual_deg_per_h", r.offset},
                        {"z", r.z},
                        {"says", r.says}});
  }
  for (const model::MissingEffect& m : d.missing) missing.push_back(missing_json(m));
  for (const model::NotTestable& n : d.not_testable) {
    not_testable.push_back({{"effect", n.effect}, {"because", n.because}});
  }
  for (const model::Bound& b : d.bounds) {
    bounds.push_back(
        {{"effect", b.effect}, {"absent_or_below", b.absent_or_below}, {"unit", b.unit}});
  }
  for (const model::NextMeasurement& n : d.next_measurements) {
    next.push_back(
        {{"tells_apart", n.tells_apart},
         {"do", n.action},
         {"expected_sigma", n.separation > 0.0 ? ordered_json(n.separation) : ordered_json()},
         {"bench_hours", n.hours > 0.0 ? ordered_json(n.hours) : ordered_json()}});
  }
  for (const model::LadderStep& step : d.ladder) {
    ladder.push_back({{"added", step.added.empty() ? ordered_json() : ordered_json(step.added)},
                      {"rms", step.rms},
                      {"heldout_rms", step.heldout_rms}});
  }
  const std::string& suggestion = d.unexplained.suggestion;
  return {{"verdict", model::name_of(d.verdict)},
          {"p_adequate", d.p_adequate},
          {"false_alarm_rate", d.false_alarm_rate},
          {"fit",
           {{"rms_deg_per_h", d.before.fit.rms},
            {"heldout_rms_deg_per_h", d.heldout_rms},
            {"noise_floor_deg_per_h", d.noise_floor}}},
          {"noise",
           {{"N_deg_per_sqrt_h", d.noise.angle_random_walk_deg_per_sqrt_h},
            {"B_deg_per_h", d.noise.bias_instability_deg_per_h},
            {"K_deg_per_h_per_sqrt_h", d.noise.rate_random_walk_deg_per_h_per_sqrt_h}}},
          {"failures", failures},
          {"missing", missing},
          {"ambiguous", d.ambiguous},
          {"unexplained",
           {{"p_value", d.unexplained.p_value},
            {"depends_on", d.unexplained.depends_on},
            {"suggestion", suggestion.empty() ? ordered_json() : ordered_json(suggestion)}}},
          {"not_testable", not_testable},
          {"bounds", bounds},
          {"next_measurements", next},
          {"ladder", ladder},
          {"sentences", d.sentences},
          {"next", next_step(d, options)}};
}

void print_text(const model::Diagnosis& d, const DiagnoseOptions& options, std::string_view unit) {
  const std::string in(unit);
  for (const std::string& sentence : d.sentences) fmt::print("{}\n", sentence);
  fmt::print("\n");
  std::size_t shown = 0;
  constexpr std::size_t kMostFailures = 3;
  for (const model::Region& r : d.before.regions) {
    if (!d.before.noise_known || r.p_family_wise > d.false_alarm_rate) continue;
    if (shown++ == 0) fmt::print("Where the model fails most:\n");
    fmt::print("  {}\n", r.says);
    if (shown == kMostFailures) break;
  }
  if (shown > 0) fmt::print("\n");

  TextTable ladder({{"model", "", TextTable::Align::kLeft},
                    {"RMS", in},
                    {"held-out RMS", in},
                    {"noise floor", in}});
  for (const model::LadderStep& step : d.ladder) {
    ladder.add_row({step.added.empty() ? "as it came" : "+ " + step.added,
                    fmt::format("{:.3g}", step.rms), fmt::format("{:.3g}", step.heldout_rms),
                    std::isfinite(d.noise_floor) ? fmt::format("{:.3g}", d.noise_floor) : "-"});
  }
  fmt::print("{}\n", ladder.text());
  if (!d.not_testable.empty()) fmt::print("Not testable with these data:\n");
  for (const model::NotTestable& n : d.not_testable) {
    fmt::print("  {}: {}\n", n.effect, n.because);
  }
  if (!d.next_measurements.empty()) fmt::print("\nWhat to measure next:\n");
  for (const model::NextMeasurement& n : d.next_measurements) {
    fmt::print("  {} (for {})\n", n.action, fmt::join(n.tells_apart, ", "));
  }
  if (!options.report.empty()) fmt::print("\nReport: {}\n", options.report);
  fmt::print("\nNext: {}\n", next_step(d, options));
}

Result<model::DiagnoseOptions> options_of(const DiagnoseOptions& options) {
  model::DiagnoseOptions out;
  out.seed = options.seed;
  for (const std::string& name : options.candidates) {
    const auto file = config::find_config("models", name);
    if (!file) return file.error();
    const auto model = config::load_model(*file);
    if (!model) return model.error();
    out.candidates.insert(out.candidates.end(), model->terms.begin(), model->terms.end());
  }
  if (progress_wanted()) {
    out.progress = [](const std::string& part, double share) {
      fmt::print(stderr, "\r\033[K");
      if (share < 1.0) fmt::print(stderr, "{:3.0f} %  {}", 100.0 * share, part);
      std::fflush(stderr);
    };
  }
  return out;
}

Result<ExitStatus> run_diagnose(const DiagnoseOptions& options) {
  const auto file = config::find_config("models", options.model);
  if (!file) return file.error();
  const auto model = config::load_model(*file);
  if (!model) return model.error();
  // Whether the page can be written is better known before the work.
  std::unique_ptr<config::OutputFile> page;
  if (!options.report.empty()) {
    auto opened = config::OutputFile::open(options.report);
    if (!opened) return opened.error();
    page = std::move(*opened);
  }
  const auto table = load_table(options.data);
  if (!table) return table.error();
  auto how = options_of(options);
  if (!how) return how.error();
  std::optional<model::Table> quiet;
  if (!options.quiet.empty()) {
    DataOptions record = options.data;
    record.data = {options.quiet};
    record.segment.clear();
    auto loaded = load_table(record);
    if (!loaded) return loaded.error();
    quiet = std::move(*loaded);
    how->quiet = &*quiet;
  }
  const auto result = model::diagnose(*table, *model, *how);
  if (!result) return result.error();
  if (page) {
    Status written = page->write(model::diagnosis_html(*result, *model, data_name(options.data)));
    if (written) written = page->commit();
    if (!written) return written.error();
  }
  if (options.json) {
    print_json(to_json(*result, options));
  } else {
    print_text(*result, options, config::unit_of(model->observable));
  }
  const bool no = options.check && result->verdict != model::Verdict::kNothingMissing;
  return no ? ExitStatus::kNo : ExitStatus::kDone;
}

}  // namespace

void add_diagnose(CLI::App& app, Action& action) {
  add_command<DiagnoseOptions>(
      app, action, "diagnose", "Learn which effect a model lacks, and how sure that is",
      "  fogbench diagnose 7 --model magnetic\n"
      "  fogbench diagnose 7 --model thermal --quiet 8 --report page.html\n",
      [](CLI::App& command, DiagnoseOptions& options) {
        add_data_options(command, options.data, DataCount::kSeveral);
        command.add_option("--model", options.model, "Model file, or a ready model's name")
            ->required();
        command.add_option("--quiet", options.quiet,
                           "A static record of the same gyro: tells slow effects from noise");
        command.add_option("--candidate", options.candidates,
                           "Model file whose terms take part as candidates, beside the catalogue");
        command.add_option("--report", options.report, "Write one self-contained HTML page");
        command.add_option("--seed", options.seed, "Of the simulated noise behind the p-values");
        command.add_flag("--check", options.check, "Exit with 1 unless nothing is missing");
        command.add_flag("--json", options.json, "One JSON document");
      },
      run_diagnose);
}

}  // namespace fogbench::cli
