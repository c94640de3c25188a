// fogbench compensate: takes a fitted model out of the measurements.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/load_table.hpp"
#include "cli/output.hpp"
#include "config/model_file.hpp"
#include "config/paths.hpp"
#include "model/fit/compensate.hpp"
#include "model/table/write_csv.hpp"

namespace fogbench::cli {
namespace {

struct CompensateOptions {
  DataOptions data;
  std::string model;
  std::string output;
  bool json = false;
};

Result<ExitStatus> run_compensate(const CompensateOptions& options) {
  const Result<std::filesystem::path> file = config::find_config("models", options.model);
  if (!file) return file.error();
  const Result<config::ModelFile> model = config::load_model(*file);
  if (!model) return model.error();
  Result<model::Table> table = load_table(options.data, {&*model});
  if (!table) return table.error();
  Result<model::Compensation> result = model::compensate(*table, *model);
  if (!result) return result.error();
  table->set_column(result->column, std::move(result->values));
  if (Status written = model::write_csv(*table, options.output); !written) return written.error();
  if (options.json) {
    print_json({{"rows", result->rows},
                {"rms_before", result->rms_before},
                {"rms_after", result->rms_after},
                {"deviation_before", result->deviation_before},
                {"deviation_after", result->deviation_after},
                {"column", result->column},
                {"read_as", table->provenance()},
                {"file", options.output}});
    return ExitStatus::kDone;
  }
  fmt::print("{} of {} rows compensated, unit of {}\n", result->rows, table->rows(),
             model->observable);
  fmt::print("  RMS               before {:.6g}   after {:.6g}\n", result->rms_before,
             result->rms_after);
  fmt::print("  about the mean    before {:.6g}   after {:.6g}\n", result->deviation_before,
             result->deviation_after);
  fmt::print("Written to {}, column {}\n", options.output, result->column);
  return ExitStatus::kDone;
}

}  // namespace

void add_compensate(CLI::App& app, Action& action) {
  add_command<CompensateOptions>(
      app, action, "compensate", "Take a fitted model out of measurements",
      "  fogbench compensate 7 --model fitted.json -o compensated.csv\n",
      [](CLI::App& command, CompensateOptions& options) {
        add_data_options(command, options.data);
        command.add_option("--model", options.model, "Fitted model file")->required();
        command.add_option("-o,--output", options.output, "CSV file to write")->required();
        command.add_flag("--json", options.json, "One JSON document");
      },
      run_compensate);
}

}  // namespace fogbench::cli
