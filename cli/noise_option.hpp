#pragma once
// --noise, as fit, compare and diagnose take it: what is known of the gyro's noise beforehand.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "cli/load_table.hpp"
#include "config/result.hpp"
#include "model/fit/fit.hpp"
#include "model/table/table.hpp"

namespace fogbench::cli {

struct ChosenNoise {
  model::FitOptions::Noise kind = model::FitOptions::Noise::kAuto;
  model::NoisePrior prior;
  std::optional<model::Table> record;  ///< the static record that the prior was taken from
};

void add_noise_option(CLI::App& command, std::string& noise);

/// auto (also when empty), independent, coloured; a grade (tactical, navigation); N,B,K of a data
/// sheet in deg/sqrt(h), deg/h and deg/h/sqrt(h); or a static record, named as DATA is and read
/// with the same columns. Errors: kUsage: none of these; kBadInput: a record or a data sheet that
/// no noise can be taken from.
Result<ChosenNoise> chosen_noise(const std::string& noise, const DataOptions& data);

}  // namespace fogbench::cli
