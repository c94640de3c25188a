// fogbench diagnose: which effect a model lacks, how sure that is, or that nothing is missing.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "cli/bench_reach.hpp"
#include "cli/command.hpp"
#include "cli/diagnosis_json.hpp"
#include "cli/diagnosis_text.hpp"
#include "cli/fit_record.hpp"
#include "cli/load_table.hpp"
#include "cli/noise_option.hpp"
#include "cli/output.hpp"
#include "cli/page_file.hpp"
#include "cli/shell_word.hpp"
#include "config/output_file.hpp"
#include "config/paths.hpp"
#include "config/rounding.hpp"
#include "config/units.hpp"
#include "model/diagnose/diagnose.hpp"
#include "model/diagnose/verdict_text.hpp"
#include "model/diagnose/working_table.hpp"
#include "model/effects/catalogue.hpp"
#include "model/report/diagnosis_report.hpp"

namespace fogbench::cli {
namespace {

using nlohmann::ordered_json;

struct DiagnoseOptions {
  DataOptions data;
  std::string model;
  std::string quiet, noise;
  std::string report;
  std::string output;
  std::string bench;
  std::vector<std::string> candidates;
  std::uint64_t seed = model::DiagnoseOptions{}.seed;
  bool each = false;
  bool check = false;
  bool json = false;
};

/// What to type next; `fitted`: the model came with its coefficients.
std::string next_step(const model::Diagnosis& d, const DiagnoseOptions& options, bool fitted) {
  const std::string data = data_arguments(options.data), model = shell_word(options.model);
  if (!options.output.empty()) {
    return fmt::format("fogbench compare {} --model {}", data, shell_word(options.output));
  }
  if (d.verdict == model::Verdict::kNothingMissing) {
    return command_with_adequate(options.data, options.model, fitted);
  }
  // Nothing that could be added: a look at the residual is next.
  if (d.missing.empty() || (d.verdict == model::Verdict::kUnexplained && !d.far_from_floor)) {
    return options.report.empty()
               ? fmt::format("fogbench diagnose {} --model {} --report page.html", data, model)
               : fmt::format("fogbench compare {} --model {}", data, model);
  }
  std::vector<std::string> effects;
  for (const model::MissingEffect& m : d.missing) {
    effects.insert(effects.end(), m.terms.begin(), m.terms.end());
  }
  const bool in_catalogue = std::all_of(effects.begin(), effects.end(), [](const std::string& id) {
    return model::find_effect(id) != nullptr;
  });
  if (in_catalogue) {
    for (std::string& effect : effects) effect = shell_word(effect);
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

void clear_progress() {
  if (progress_wanted()) fmt::print(stderr, "\r\033[K");
}

/// The model with what was found, fitted: ready for compare, compensate and the next diagnosis.
Result<std::string> extended_model(const model::Diagnosis& d, const DataOptions& data) {
  config::ModelFile extended = d.after.fitted;
  if (extended.fit) {
    if (Status signed_ok = sign(*extended.fit, data, d.table.provenance()); !signed_ok)
      return signed_ok.error();
  }
  return config::to_json_text(extended);
}

/// Opened before the work, so that a path that cannot be written is known at once.
struct Files {
  std::optional<PageFile> page;
  std::unique_ptr<config::OutputFile> model;
};

Result<Files> open_files(const DiagnoseOptions& options) {
  Files files;
  if (!options.report.empty()) {
    auto page = PageFile::open(options.report);
    if (!page) return page.error();
    files.page = std::move(*page);
  }
  if (!options.output.empty()) {
    auto model = config::OutputFile::open(options.output);
    if (!model) return model.error();
    files.model = std::move(*model);
  }
  return files;
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

/// What every diagnosis of one call needs.
struct Given {
  config::ModelFile model;
  model::DiagnoseOptions how;
  std::optional<model::Table> quiet;
};

/// The static record is read into `given`, which has to stay where it is.
Status read_given(const DiagnoseOptions& options, Given& given) {
  const auto file = config::find_config("models", options.model);
  if (!file) return file.error();
  auto model = config::load_model(*file);
  if (!model) return model.error();
  given.model = std::move(*model);
  auto how = options_of(options);
  if (!how) return how.error();
  given.how = std::move(*how);
  const auto reach = bench_reach(options.bench, options.data);
  if (!reach) return reach.error();
  given.how.reach = *reach;
  auto noise = chosen_noise(options.noise, options.data);
  if (!noise) return noise.error();
  given.how.prior = noise->prior;
  // A static record, by whichever name it is given, takes part in every estimate of the noise.
  given.quiet = std::move(noise->record);
  if (given.quiet) given.how.quiet = &*given.quiet;
  if (options.quiet.empty()) return {};
  const Status one = expect_one_gyro({options.data.data.front(), options.quiet}, options.data);
  if (!one) return one.error();
  DataOptions record = options.data;
  record.data = {options.quiet};
  record.segment.clear();
  record.tests.clear();
  auto loaded = load_table(record, {&given.model, model::kMostRowsToRead});
  if (!loaded) return loaded.error();
  given.quiet = std::move(*loaded);
  given.how.quiet = &*given.quiet;
  return {};
}

ExitStatus status_of(const model::Diagnosis& d, const DiagnoseOptions& options) {
  return options.check && !model::found_adequate(d) ? ExitStatus::kNo : ExitStatus::kDone;
}

/// One table of several, diagnosed by itself.
struct OfEach {
  DiagnoseOptions options;  ///< with its DATA alone
  std::optional<Result<model::Diagnosis>> result;
};

Result<model::Diagnosis> diagnosed(const DiagnoseOptions& options, const Given& given) {
  const auto table = load_table(options.data, {&given.model, model::kMostRowsToRead});
  if (!table) return table.error();
  auto result = model::diagnose(*table, given.model, given.how);
  if (!result) return result;
  for (const std::string& line : table->provenance()) result->table.add_provenance(line);
  return result;
}

void print_each(const OfEach& one, std::string_view unit) {
  const std::string name = data_name(one.options.data);
  if (!*one.result) {
    fmt::print("{}: {}\n", name, one.result->error().message);
    return;
  }
  const model::Diagnosis& d = **one.result;
  const double rms = d.ladder.empty() ? d.after.rms : d.ladder.back().rms;
  fmt::print("{}: {}: {} RMS {} {}, noise floor {}.\n", name, model::verdict_of(d),
             model::verdict_in_words(d, "").verdict, config::significant(rms, 3), unit,
             config::significant(d.noise_floor, 3));
}

ordered_json json_of_each(const OfEach& one, bool fitted) {
  ordered_json out{{"data", data_name(one.options.data)}};
  if (!*one.result) {
    out["error"] = one.result->error().message;
  } else {
    const model::Diagnosis& d = **one.result;
    out.update(diagnosis_json(d, next_step(d, one.options, fitted)));
  }
  return out;
}

/// Several tables, each by itself, two at a time: with the seed that they share, what is said of
/// one does not depend on the others. A table that cannot be read does not keep the others from
/// being looked at.
Result<ExitStatus> run_each(const DiagnoseOptions& options) {
  if (!options.report.empty() || !options.output.empty()) {
    return Error{ErrorCode::kUsage,
                 "--each prints one line a table; --report and -o take one table"};
  }
  Given given;
  if (Status read = read_given(options, given); !read) return read.error();
  given.how.progress = {};
  std::vector<OfEach> all;
  for (const std::string& data : options.data.data) {
    all.push_back({options, {}});
    all.back().options.data.data = {data};
  }
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < all.size(); i = next++) {
      all[i].result.emplace(diagnosed(all[i].options, given));
    }
  };
  std::thread other(work);
  work();
  other.join();

  ExitStatus worst = ExitStatus::kDone;
  ordered_json documents = ordered_json::array();
  for (const OfEach& one : all) {
    const ExitStatus its = *one.result ? status_of(**one.result, options)
                                       : config::exit_status(one.result->error().code);
    worst = std::max(worst, its);
    if (options.json) {
      documents.push_back(json_of_each(one, given.model.fit.has_value()));
    } else {
      print_each(one, config::unit_of(given.model.observable));
    }
  }
  if (options.json) print_json(documents);
  return worst;
}

Result<ExitStatus> run_diagnose(const DiagnoseOptions& options) {
  if (options.each) return run_each(options);
  auto files = open_files(options);
  if (!files) return files.error();
  Given given;
  if (Status read = read_given(options, given); !read) return read.error();
  const auto result = diagnosed(options, given);
  clear_progress();
  if (!result) return result.error();
  const std::string next = next_step(*result, options, given.model.fit.has_value());
  const model::VerdictWords words = model::verdict_in_words(*result, next);
  if (files->page) {
    const Status written = files->page->write(
        model::diagnosis_html(*result, words, given.model, data_name(options.data)));
    if (!written) return written.error();
  }
  if (files->model) {
    const auto text = extended_model(*result, options.data);
    if (!text) return text.error();
    Status written = files->model->write(*text);
    if (written) written = files->model->commit();
    if (!written) return written.error();
  }
  if (options.json) {
    print_json(diagnosis_json(*result, next));
  } else {
    print_diagnosis(*result, words, config::unit_of(given.model.observable));
    if (!options.report.empty()) fmt::print("\nReport: {}\n", options.report);
    if (!options.output.empty()) fmt::print("\nModel written to {}\n", options.output);
  }
  return status_of(*result, options);
}

}  // namespace

void add_diagnose(CLI::App& app, Action& action) {
  add_command<DiagnoseOptions>(
      app, action, "diagnose", "Learn which effect a model lacks, and how sure that is",
      "  fogbench diagnose 7 --model magnetic\n"
      "  fogbench diagnose 7 --model thermal --quiet 8 --report page.html -o wider.json\n"
      "  fogbench diagnose --each run-*.csv --model magnetic\n",
      [](CLI::App& command, DiagnoseOptions& options) {
        add_data_options(command, options.data, DataCount::kSeveral);
        command.add_option("--model", options.model, "Model file, or a ready model's name")
            ->required();
        command.add_option("--quiet", options.quiet,
                           "A static record of the same gyro: tells slow effects from noise");
        add_noise_option(command, options.noise);
        command.add_option("--candidate", options.candidates,
                           "Model file whose terms take part as candidates, beside the catalogue");
        command.add_option(
            "--report", options.report,
            "Write one self-contained HTML page, or its print when the name ends with .pdf");
        command.add_option("-o,--output", options.output,
                           "Write the model with what was found, fitted");
        command.add_option("--bench", options.bench,
                           "The bench that will do what is proposed: nothing beyond its limits is "
                           "(default: the run's own)");
        command.add_option("--seed", options.seed, "Of the simulated noise behind the p-values");
        command.add_flag("--each", options.each,
                         "Diagnose every DATA by itself: a line each, the worst exit status");
        command.add_flag("--check", options.check, "Exit with 1 unless nothing is missing");
        command.add_flag("--json", options.json, "One JSON document");
      },
      run_diagnose);
}

}  // namespace fogbench::cli
