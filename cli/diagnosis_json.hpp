#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "model/diagnose/diagnose.hpp"

namespace fogbench::cli {

/// What `fogbench diagnose --json` prints. Numbers that are not known are null. Its sentences are
/// the verdict, the evidence, what to do, then the details (verdict_in_words).
nlohmann::ordered_json diagnosis_json(const model::Diagnosis& diagnosis,
                                      const std::string& next_step);

}  // namespace fogbench::cli
