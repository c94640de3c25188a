#pragma once

#include "cli/load_table.hpp"
#include "config/model_file.hpp"
#include "config/result.hpp"

namespace fogbench::cli {

/// Notes in a fitted model's record which data it comes from (with their hash, and how they were
/// read), when, and from which version. Errors: kStore when a file cannot be read.
Status sign(config::FitRecord& record, const DataOptions& data,
            const std::vector<std::string>& read_as);

}  // namespace fogbench::cli
