#pragma once

#include <string>
#include <vector>

#include "model/diagnose/diagnose.hpp"

namespace fogbench::model {

/// The diagnosis in plain sentences, the verdict first.
std::vector<std::string> verdict_in_words(const Diagnosis& diagnosis);

}  // namespace fogbench::model
