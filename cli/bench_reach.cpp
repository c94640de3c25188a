#include "cli/bench_reach.hpp"

#include <nlohmann/json.hpp>

#include "cli/common_options.hpp"
#include "config/bench.hpp"
#include "config/paths.hpp"
#include "record/run_log_reader.hpp"

namespace fogbench::cli {
namespace {

using nlohmann::json;

void take(const json& object, const char* key, double& value) {
  const auto found = object.find(key);
  if (found != object.end() && found->is_number()) value = found->get<double>();
}

/// What bounds a bench, out of the files' texts that a run's record keeps; what they do not say
/// is as in a bench file that does not say it.
model::BenchReach recorded_reach(const std::string& bench_json) {
  config::BenchConfig bench;
  for (const json& text : json::parse(bench_json, nullptr, false)) {
    if (!text.is_string()) continue;
    const json file = json::parse(text.get_ref<const std::string&>(), nullptr, false);
    if (!file.is_object() || !file.contains("gyro")) continue;  // a device's
    const json limits = file.value("limits", json::object());
    take(limits, "field_maximum_ut", bench.limits.field_maximum.value);
    take(limits, "compensation_maximum_ut", bench.limits.compensation_maximum.value);
    take(limits, "temperature_maximum_c", bench.limits.temperature_maximum.value);
    for (const auto& [name, coil] : {std::pair{"coil_horizontal", &bench.coil_horizontal},
                                     std::pair{"coil_vertical", &bench.coil_vertical}}) {
      const json its = file.value(name, json::object());
      take(its, "field_ut_per_a", coil->field_ut_per_a);
      take(its, "current_limit_a", coil->current_limit.value);
    }
  }
  return model::reach_of(bench);
}

}  // namespace

Result<model::BenchReach> bench_reach(const std::string& bench, const DataOptions& data) {
  if (!bench.empty()) {
    const auto file = config::find_config("benches", bench);
    if (!file) return file.error();
    const auto config = config::load_bench(*file);
    if (!config) return config.error();
    return model::reach_of(*config);
  }
  const auto named = data.data.empty() ? std::nullopt : run_in_store(data.data.front(), data);
  if (!named) return model::BenchReach{};
  const auto path = store_to_read(named->store);
  if (!path) return path.error();
  auto reader = record::RunLogReader::open(*path);
  if (!reader) return reader.error();
  const auto run = (*reader)->run(named->run);
  if (!run) return run.error();
  return recorded_reach(run->header.bench_json);
}

}  // namespace fogbench::cli
