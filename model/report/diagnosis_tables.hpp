#pragma once
// The tables of a diagnosis' page, each with its heading; empty where there is nothing to say.

#include <string>
#include <string_view>

#include "model/diagnose/diagnose.hpp"

namespace fogbench::model {

/// "0.012", or that it is below 0.0001; as HTML.
std::string p_text(double p);

std::string ladder_section(const Diagnosis& diagnosis, std::string_view unit);
std::string ranking_section(const Diagnosis& diagnosis);
std::string failures_section(const Diagnosis& diagnosis);
std::string parameters_section(const Diagnosis& diagnosis);
std::string noise_section(const Diagnosis& diagnosis);
std::string bounds_section(const Diagnosis& diagnosis);
std::string not_testable_section(const Diagnosis& diagnosis);
std::string next_section(const Diagnosis& diagnosis);

}  // namespace fogbench::model
