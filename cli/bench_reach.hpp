#pragma once
// The bench that would do what a diagnosis proposes.

#include <string>

#include "cli/load_table.hpp"
#include "model/next/experiments.hpp"

namespace fogbench::cli {

/// Of the bench that is named; without a name of the one that the first run of the data was
/// measured on, as its record has it; of a CSV file the standard procedures'.
/// Errors: kBadInput (no such bench, or it cannot be read), kStore.
Result<model::BenchReach> bench_reach(const std::string& bench, const DataOptions& data);

}  // namespace fogbench::cli
