// fogbench fit: fits an error model to measurements and writes the fitted model file.

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/fit_record.hpp"
#include "cli/load_table.hpp"
#include "cli/noise_option.hpp"
#include "cli/output.hpp"
#include "cli/shell_word.hpp"
#include "config/noise_parts.hpp"
#include "config/output_file.hpp"
#include "config/paths.hpp"
#include "config/rounding.hpp"
#include "model/fit/fit.hpp"
#include "model/table/row_order.hpp"

namespace fogbench::cli {
namespace {

/// Correlations above this are printed.
constexpr double kTellCorrelation = 0.9;

struct FitCommandOptions {
  DataOptions data;
  std::string model;
  std::string output;
  std::string weight_by;
  std::string noise;
  bool json = false;
};

struct Correlation {
  std::string a, b;
  double value;
};

std::vector<Correlation> strong_correlations(const model::FitResult& result) {
  std::vector<std::string> names;
  for (const model::Estimate& e : result.estimates) {
    if (!e.held) names.push_back(e.name);
  }
  std::vector<Correlation> strong;
  for (Eigen::Index i = 0; i < result.covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double r =
          result.covariance(i, j) / std::sqrt(result.covariance(i, i) * result.covariance(j, j));
      if (!(std::abs(r) > kTellCorrelation)) continue;
      strong.push_back({names[static_cast<std::size_t>(j)], names[static_cast<std::size_t>(i)], r});
    }
  }
  return strong;
}

void print_result(const model::FitResult& result, const FitCommandOptions& options,
                  const std::string& observable) {
  using Align = TextTable::Align;
  TextTable table({{"term", "", Align::kLeft},
                   {"estimate", "", Align::kRight},
                   {"std error", "", Align::kRight},
                   {"expanded", "95.45 %", Align::kRight},
                   {"unit", "", Align::kLeft}});
  for (const model::Estimate& e : result.estimates) {
    if (!e.unexcited.empty()) {
      table.add_row({e.name, "not excited", "-", "-", e.unit});
      continue;
    }
    const double expanded = e.coverage_factor * e.standard_error;
    const config::Rounded r = config::rounded(e.value, e.held ? 0.0 : e.standard_error);
    table.add_row({e.name, r.value, e.held ? "held" : r.uncertainty,
                   e.held ? "" : config::rounded(0.0, expanded).uncertainty, e.unit});
  }
  fmt::print("{}\n", table.text());
  fmt::print("{} rows, {:g} degrees of freedom, RMS {:.4g} (unit of {})\n", result.rows.size(),
             result.degrees_of_freedom, result.rms, observable);
  if (!result.noise.says.empty()) fmt::print("noise: {}\n", result.noise.says);
  for (const Correlation& c : strong_correlations(result)) {
    fmt::print("correlation {:+.3f}: {} with {}\n", c.value, c.a, c.b);
  }
  for (const std::string& warning : result.warnings) fmt::print("warning: {}\n", warning);
  fmt::print("\nWritten to {}\nNext: fogbench compare {} --model {}\n", options.output,
             data_arguments(options.data), shell_word(options.output));
}

nlohmann::json to_json(const model::FitResult& result) {
  nlohmann::json estimates = nlohmann::json::array();
  for (const model::Estimate& e : result.estimates) {
    estimates.push_back({{"name", e.name},
                         {"unit", e.unit},
                         {"value", e.value},
                         {"standard_error", e.standard_error},
                         {"expanded_uncertainty", e.coverage_factor * e.standard_error},
                         {"coverage_factor", e.coverage_factor},
                         {"held", e.held},
                         {"excited", e.unexcited.empty()}});
  }
  nlohmann::json correlations = nlohmann::json::array();
  for (const Correlation& c : strong_correlations(result)) {
    correlations.push_back({{"between", {c.a, c.b}}, {"correlation", c.value}});
  }
  nlohmann::json document = {{"estimates", estimates},
                             {"correlations", correlations},
                             {"rows", result.rows.size()},
                             {"degrees_of_freedom", result.degrees_of_freedom},
                             {"rms", result.rms},
                             {"residual_sum_of_squares", result.residual_sum_of_squares},
                             {"residual_standard_deviation", result.residual_standard_deviation},
                             {"warnings", result.warnings}};
  document["noise"] = {{"coloured", result.coloured}, {"says", result.noise.says}};
  if (result.coloured) {
    document["noise"].update(nlohmann::json(config::noise_json(result.noise.noise)));
  }
  return document;
}

Result<ExitStatus> run_fit(const FitCommandOptions& options) {
  const Result<std::filesystem::path> file = config::find_config("models", options.model);
  if (!file) return file.error();
  const Result<config::ModelFile> model = config::load_model(*file);
  if (!model) return model.error();
  Result<model::Table> table = load_table(options.data, {&*model});
  if (!table) return table.error();
  const std::vector<std::string> notes = model::mend_stamps(*table, model->observable);
  const auto noise = chosen_noise(options.noise, options.data);
  if (!noise) return noise.error();
  Result<model::FitResult> result =
      model::fit(*table, *model,
                 {.noise = noise->kind, .weight_by = options.weight_by, .prior = noise->prior});
  if (!result) return with_notes(result.error(), notes);
  for (const std::string& note : notes) print_note(note);
  if (Status signed_ok = sign(*result->fitted.fit, options.data, table->provenance()); !signed_ok) {
    return signed_ok.error();
  }
  const std::string text = config::to_json_text(result->fitted);
  if (Status written = config::write_file(options.output, text); !written) return written.error();
  if (options.json) {
    nlohmann::json document = to_json(*result);
    document["read_as"] = table->provenance();
    document["file"] = options.output;
    print_json(document);
  } else {
    print_result(*result, options, model->observable);
  }
  return ExitStatus::kDone;
}

}  // namespace

void add_fit(CLI::App& app, Action& action) {
  add_command<FitCommandOptions>(
      app, action, "fit", "Fit an error model to measurements",
      "  fogbench fit 7 --model magnetic -o fitted.json\n"
      "  fogbench fit config/data/paper-thermal.csv --model paper-thermal -o fitted.json\n",
      [](CLI::App& command, FitCommandOptions& options) {
        add_data_options(command, options.data, DataCount::kSeveral);
        command.add_option("--model", options.model, "Model file, or a ready model's name")
            ->required();
        command.add_option("-o,--output", options.output, "Where to write the fitted model")
            ->required();
        command.add_option("--weight-by", options.weight_by, "Column of standard deviations");
        add_noise_option(command, options.noise);
        command.add_flag("--json", options.json, "One JSON document");
      },
      run_fit);
}

}  // namespace fogbench::cli
