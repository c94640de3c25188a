// fogbench diagnose: which effect a model lacks, how sure that is, or that nothing is missing.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/diagnosis_json.hpp"
#include "cli/fit_record.hpp"
#include "cli/load_table.hpp"
#include "cli/output.hpp"
#include "cli/shell_word.hpp"
#include "config/output_file.hpp"
#include "config/paths.hpp"
#include "config/units.hpp"
#include "model/diagnose/diagnose.hpp"
#include "model/diagnose/diagnosis_report.hpp"
#include "model/diagnose/working_table.hpp"
#include "model/effect.hpp"

namespace fogbench::cli {
namespace {

struct DiagnoseOptions {
  DataOptions data;
  std::string model;
  std::string quiet;
  std::string report;
  std::string output;
  std::vector<std::string> candidates;
  std::uint64_t seed = model::DiagnoseOptions{}.seed;
  bool check = false;
  bool json = false;
};

/// What to type next.
std::string next_step(const model::Diagnosis& d, const DiagnoseOptions& options) {
  const std::string data = data_arguments(options.data), model = shell_word(options.model);
  if (!options.output.empty()) {
    return fmt::format("fogbench compare {} --model {}", data, shell_word(options.output));
  }
  if (d.missing.empty() && d.verdict == model::Verdict::kUnexplained && options.report.empty()) {
    return fmt::format("fogbench diagnose {} --model {} --report page.html", data, model);
  }
  if (d.missing.empty())
    return fmt::format("fogbench fit {} --model {} -o fitted.json", data, model);
  std::vector<std::string> effects;
  for (const model::MissingEffect& m : d.missing) effects.push_back(m.found.effect);
  const bool in_catalogue = std::all_of(effects.begin(), effects.end(), [](const std::string& id) {
    return model::find_effect(id) != nullptr;
  });
  if (in_catalogue) {
    return fmt::format(
        "fogbench add {} --model {} -o wider.json && fogbench diagnose {} --model wider.json",
        fmt::join(effects, " "), model, data);
  }
  // A change between runs, or a formula of the user's: the diagnosis writes it itself.
  std::string candidates;
  for (const std::string& file : options.candidates)
    candidates += " --candidate " + shell_word(file);
  return fmt::format(
      "fogbench diagnose {} --model {}{} -o wider.json && fogbench compare {} --model wider.json",
      data, model, candidates, data);
}

/// "first, second" under each of the headings, in the order in which they first come.
class GroupedLines {
 public:
  void add(const std::string& heading, const std::string& item) {
    const auto found = std::find_if(lines_.begin(), lines_.end(),
                                    [&](const auto& line) { return line.first == heading; });
    if (found == lines_.end()) {
      lines_.emplace_back(heading, item);
    } else {
      found->second += ", " + item;
    }
  }
  void print(const std::string& title) const {
    if (!lines_.empty()) fmt::print("{}\n", title);
    for (const auto& [heading, items] : lines_) fmt::print("  {}: {}\n", heading, items);
  }

 private:
  std::vector<std::pair<std::string, std::string>> lines_;
};

void print_bounds(const std::vector<model::Bound>& bounds) {
  GroupedLines lines;
  for (const model::Bound& b : bounds) {
    lines.add(b.unit, fmt::format("{} {:.2g}", b.effect, b.absent_or_below));
  }
  lines.print("Absent, or smaller than this (95 %):");
}

void print_not_testable(const std::vector<model::NotTestable>& effects) {
  GroupedLines lines;
  for (const model::NotTestable& n : effects) lines.add(n.because, n.effect);
  lines.print("Not testable with these data:");
}

std::string few_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 4;
  const std::size_t shown = names.size() > kMost + 1 ? kMost : names.size();
  const std::vector<std::string> first(names.begin(),
                                       names.begin() + static_cast<std::ptrdiff_t>(shown));
  const std::string rest =
      shown < names.size() ? fmt::format(" and {} more", names.size() - shown) : std::string();
  return fmt::format("{}{}", fmt::join(first, ", "), rest);
}

void print_text(const model::Diagnosis& d, const DiagnoseOptions& options, std::string_view unit) {
  const std::string in(unit);
  for (const std::string& sentence : d.sentences) fmt::print("{}\n", sentence);
  for (const std::string& warning : d.after.warnings) fmt::print("warning: {}\n", warning);
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

  const auto number = [](double value) {
    return std::isfinite(value) ? fmt::format("{:.3g}", value) : std::string("-");
  };
  TextTable ladder({{"model", "", TextTable::Align::kLeft},
                    {"RMS", in},
                    {"held-out RMS", in},
                    {"noise floor", in}});
  for (const model::LadderStep& step : d.ladder) {
    ladder.add_row({step.added.empty() ? "as it came" : "+ " + step.added, number(step.rms),
                    number(step.heldout_rms), number(d.noise_floor)});
  }
  fmt::print("{}\n", ladder.text());
  print_bounds(d.bounds);
  print_not_testable(d.not_testable);
  if (!d.next_measurements.empty()) fmt::print("\nWhat to measure next:\n");
  for (const model::NextMeasurement& n : d.next_measurements) {
    // What would show effects never seen names them itself.
    if (n.separation > 0.0) {
      fmt::print("  {} (for {})\n", n.action, few_of(n.tells_apart));
    } else {
      fmt::print("  {}\n", n.action);
    }
  }
  if (!options.report.empty()) fmt::print("\nReport: {}\n", options.report);
  if (!options.output.empty()) fmt::print("\nModel written to {}\n", options.output);
  fmt::print("\nNext: {}\n", next_step(d, options));
}

void clear_progress() {
  if (progress_wanted()) fmt::print(stderr, "\r\033[K");
}

/// The model with what was found, fitted: ready for compare, compensate and the next diagnosis.
Result<std::string> extended_model(const model::Diagnosis& d, const DataOptions& data) {
  config::ModelFile extended = d.after.fitted;
  if (extended.fit) {
    if (Status signed_ok = sign(*extended.fit, data); !signed_ok) return signed_ok.error();
  }
  return config::to_json_text(extended);
}

/// Opened before the work, so that a path that cannot be written is known at once. Null: none.
Result<std::unique_ptr<config::OutputFile>> opened(const std::string& path) {
  if (path.empty()) return std::unique_ptr<config::OutputFile>();
  return config::OutputFile::open(path);
}

Status put(config::OutputFile& file, const std::string& text) {
  Status written = file.write(text);
  return written ? file.commit() : written;
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
      clear_progress();
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
  const auto page_file = opened(options.report), model_file = opened(options.output);
  if (!page_file) return page_file.error();
  if (!model_file) return model_file.error();
  config::OutputFile *page = page_file->get(), *extended = model_file->get();
  const auto table = load_table(options.data, model::kMostRowsToRead);
  if (!table) return table.error();
  auto how = options_of(options);
  if (!how) return how.error();
  std::optional<model::Table> quiet;
  if (!options.quiet.empty()) {
    DataOptions record = options.data;
    record.data = {options.quiet};
    record.segment.clear();
    auto loaded = load_table(record, model::kMostRowsToRead);
    if (!loaded) return loaded.error();
    quiet = std::move(*loaded);
    how->quiet = &*quiet;
  }
  const auto result = model::diagnose(*table, *model, *how);
  clear_progress();
  if (!result) return result.error();
  if (page) {
    const Status written =
        put(*page, model::diagnosis_html(*result, *model, data_name(options.data)));
    if (!written) return written.error();
  }
  if (extended) {
    const auto text = extended_model(*result, options.data);
    if (!text) return text.error();
    if (Status written = put(*extended, *text); !written) return written.error();
  }
  if (options.json) {
    print_json(diagnosis_json(*result, next_step(*result, options)));
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
      "  fogbench diagnose 7 --model thermal --quiet 8 --report page.html -o wider.json\n",
      [](CLI::App& command, DiagnoseOptions& options) {
        add_data_options(command, options.data, DataCount::kSeveral);
        command.add_option("--model", options.model, "Model file, or a ready model's name")
            ->required();
        command.add_option("--quiet", options.quiet,
                           "A static record of the same gyro: tells slow effects from noise");
        command.add_option("--candidate", options.candidates,
                           "Model file whose terms take part as candidates, beside the catalogue");
        command.add_option("--report", options.report, "Write one self-contained HTML page");
        command.add_option("-o,--output", options.output,
                           "Write the model with what was found, fitted");
        command.add_option("--seed", options.seed, "Of the simulated noise behind the p-values");
        command.add_flag("--check", options.check, "Exit with 1 unless nothing is missing");
        command.add_flag("--json", options.json, "One JSON document");
      },
      run_diagnose);
}

}  // namespace fogbench::cli
