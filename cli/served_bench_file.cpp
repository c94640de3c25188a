#include "cli/served_bench_file.hpp"

#include <nlohmann/json.hpp>

#include "config/bench.hpp"
#include "config/json_file.hpp"

namespace fogbench::cli {
namespace fs = std::filesystem;

Result<std::string> served_bench_json(const fs::path& file,
                                      const std::vector<simulator::ServedInstrument>& instruments,
                                      double frame_rate_hz) {
  const auto text = config::read_text_file(file);
  if (!text) return text.error();
  // Ordered, so that the file reads like the one that it was made from.
  auto bench = nlohmann::ordered_json::parse(*text, nullptr, false);
  if (!bench.is_object()) {
    return Error{ErrorCode::kBadInput, file.string() + ": an object was expected"};
  }
  const auto absolute = [&](const std::string& name) {
    std::error_code ignored;
    const auto device = config::device_file(file, name);
    return device ? fs::absolute(*device, ignored).lexically_normal().string() : name;
  };
  bench.erase("$schema");
  bench.erase("simulation");
  bench["name"] = bench.value("name", "simulated") + "-served";
  bench["description"] = "Served by fogbench simulate --serve; good as long as that runs.";
  const auto entry_of = [&](const std::string& name) -> nlohmann::ordered_json& {
    if (bench.contains("auxiliary")) {
      for (auto& sensor : bench["auxiliary"]) {
        if (sensor.value("name", "") == name) return sensor;
      }
    }
    return bench[name];
  };
  for (const simulator::ServedInstrument& instrument : instruments) {
    auto& entry = entry_of(instrument.name);
    entry["connection"] = instrument.connection;
    if (entry.contains("device")) entry["device"] = absolute(entry["device"].get<std::string>());
  }
  bench["gyro"]["frame_rate_hz"] = frame_rate_hz;
  return config::pretty_json(bench) + "\n";
}

}  // namespace fogbench::cli
