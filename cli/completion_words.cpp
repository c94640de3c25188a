#include "cli/completion_words.hpp"

#include <algorithm>

#include "cli/common_options.hpp"
#include "config/paths.hpp"
#include "config/procedure.hpp"
#include "model/effects/catalogue.hpp"
#include "record/run_log_reader.hpp"

namespace fogbench::cli {
namespace {

using Words = std::vector<std::string>;

Words runs_of(const std::string& store) {
  Words words;
  const auto path = store_to_read(store);
  if (!path) return words;
  const auto reader = record::RunLogReader::open(*path);
  if (!reader) return words;
  const auto runs = (*reader)->runs();
  if (!runs) return words;
  for (const record::StoredRun& run : *runs) words.push_back(std::to_string(run.run));
  return words;
}

Words parameters_of(const Words& typed) {
  Words words;
  for (const std::string& word : typed) {
    const auto file = config::find_config("procedures", word);
    if (!file) continue;
    const auto procedure = config::load_procedure(*file);
    if (!procedure) continue;
    for (const auto& parameter : procedure->parameters) words.push_back(parameter.first + "=");
  }
  return words;
}

}  // namespace

std::optional<Words> asked_words(const CLI::App& app, const Words& arguments) {
  if (arguments.size() < 2 || arguments[0] != "--words") return std::nullopt;
  const std::string& kind = arguments[1];
  const Words typed(arguments.begin() + 2, arguments.end());
  Words words;
  if (kind == "effects") {
    for (const model::Effect* effect : model::catalogue()) {
      words.emplace_back(effect->info().id);
    }
  } else if (kind == "topics") {
    words.emplace_back("expressions");
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
      words.push_back(command->get_name());
    }
  } else if (kind == "runs") {
    const auto store = std::find(typed.begin(), typed.end(), "--store");
    words = runs_of(store == typed.end() || store + 1 == typed.end() ? "" : *(store + 1));
  } else if (kind == "parameters") {
    words = parameters_of(typed);
  }
  return words;
}

}  // namespace fogbench::cli
