#pragma once
// Acceptance limits, kept apart from the procedure (config/limits/*.json).

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "config/result.hpp"

namespace fogbench::config {

/// A limit on one result ("magnetic_linear_z", "temperature_sigma", "K_z").
struct Limit {
  std::string quantity;
  std::optional<double> minimum;
  std::optional<double> maximum;
  std::string unit;
};

struct LimitsConfig {
  std::string name;
  std::string description;
  std::vector<Limit> limits;
};

/// Errors: kBadInput, one line with the file and the JSON pointer.
Result<LimitsConfig> load_limits(const std::filesystem::path& file);

}  // namespace fogbench::config
