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
  std::optional<double> repeatability;  ///< largest change from one test to the next, either way
  std::optional<int> tests;             ///< where it is not LimitsConfig::tests
  std::string unit;
};

struct LimitsConfig {
  std::string name;
  std::string description;
  /// Of the expanded uncertainty, which is the guard band on either side of a limit.
  double coverage_factor = 2.0;
  /// In how many tests every quantity has to be measured.
  int tests = 1;
  std::vector<Limit> limits;
};

/// Errors: kBadInput, one line with the file and the JSON pointer.
Result<LimitsConfig> load_limits(const std::filesystem::path& file);

}  // namespace fogbench::config
