#include "daemon/parameters_json.hpp"

#include <nlohmann/json.hpp>
#include <utility>
#include <variant>
#include <vector>

namespace fogbench::daemon {

nlohmann::ordered_json to_json(const config::Parameters& parameters) {
  nlohmann::ordered_json values = nlohmann::ordered_json::object();
  for (const auto& [name, value] : parameters) {
    std::visit([&, &key = name](const auto& v) { values[key] = v; }, value);
  }
  return values;
}

std::optional<config::Parameters> parameters_of(const nlohmann::json& set) {
  config::Parameters parameters;
  if (!set.is_object()) return std::nullopt;
  for (const auto& [name, value] : set.items()) {
    if (value.is_number()) {
      parameters[name] = value.get<double>();
      continue;
    }
    if (!value.is_array()) return std::nullopt;
    std::vector<double> list;
    for (const nlohmann::json& entry : value) {
      if (!entry.is_number()) return std::nullopt;
      list.push_back(entry.get<double>());
    }
    parameters[name] = std::move(list);
  }
  return parameters;
}

}  // namespace fogbench::daemon
