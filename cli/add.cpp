// fogbench add: extends a model file with effects of the catalogue.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/output.hpp"
#include "config/model_file.hpp"
#include "config/output_file.hpp"
#include "config/paths.hpp"
#include "model/effects/catalogue.hpp"

namespace fogbench::cli {
namespace {

struct AddOptions {
  std::vector<std::string> effects;
  std::string model;
  std::string output;
  bool json = false;
};

Result<ExitStatus> run_add(const AddOptions& options) {
  const Result<std::filesystem::path> file = config::find_config("models", options.model);
  if (!file) return file.error();
  Result<config::ModelFile> model = config::load_model(*file);
  if (!model) return model.error();
  for (const std::string& id : options.effects) {
    if (model::find_effect(id) == nullptr) {
      return Error{ErrorCode::kBadInput, model::unknown_effect(id)};
    }
    const bool known = std::any_of(model->terms.begin(), model->terms.end(),
                                   [&](const config::ModelTerm& t) { return t.effect == id; });
    if (known) {
      return Error{
          ErrorCode::kBadInput,
          fmt::format("{}: found the effect {} already, expected a new one", file->string(), id)};
    }
    config::ModelTerm term;
    term.effect = id;
    model->terms.push_back(std::move(term));
  }
  // What a fit had found is not true of the extended model.
  model->fit.reset();
  for (config::ModelTerm& term : model->terms) term.standard_errors.clear();
  if (Status written = config::write_file(options.output, config::to_json_text(*model)); !written) {
    return written.error();
  }
  if (options.json) {
    print_json(
        {{"file", options.output}, {"added", options.effects}, {"terms", model->terms.size()}});
    return ExitStatus::kDone;
  }
  fmt::print("{}: {} terms, with {} added; compare, fit and diagnose take it with --model\n",
             options.output, model->terms.size(), fmt::join(options.effects, ", "));
  return ExitStatus::kDone;
}

}  // namespace

void add_add(CLI::App& app, Action& action) {
  add_command<AddOptions>(
      app, action, "add", "Extend a model with effects of the catalogue",
      "  fogbench add magnetic_hysteresis_z --model magnetic -o extended.json\n",
      [](CLI::App& command, AddOptions& options) {
        command.add_option("EFFECT", options.effects, "Effects to add (see fogbench effects)")
            ->required();
        command.add_option("--model", options.model, "Model file, or a ready model's name")
            ->required();
        command.add_option("-o,--output", options.output, "Where to write the extended model")
            ->required();
        command.add_flag("--json", options.json, "One JSON document");
      },
      run_add);
}

}  // namespace fogbench::cli
