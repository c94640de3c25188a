#pragma once
// What a comparison says in words: how well the model fits against what noise allows, where it
// fails first, what rounding of given coefficients may explain, what changed between runs.

#include <string>

#include "model/compare/compare.hpp"

namespace fogbench::model {

/// Fills `changes` and `sentences`. `noise_says`: where the noise comes from.
void conclude(Comparison& comparison, const Table& table, const config::ModelFile& model,
              const FitOptions& options, const std::string& noise_says);

/// "p < 0.0001", "p = 0.03".
std::string probability_text(double p);

}  // namespace fogbench::model
