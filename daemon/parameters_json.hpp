#pragma once
// A procedure's parameters as JSON: {"average_s": 5, "levels_ut": [0, 300]}.

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "config/procedure.hpp"

namespace fogbench::daemon {

nlohmann::ordered_json to_json(const config::Parameters& parameters);

/// Nothing when it is not of that shape.
std::optional<config::Parameters> parameters_of(const nlohmann::json& set);

}  // namespace fogbench::daemon
