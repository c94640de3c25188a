#pragma once
// A diagnosis as one self-contained HTML page: the verdict, the ladder of errors as effects are
// added, the plots before and after, what competed, the coefficients, what was not found, what
// could not be tested, what to measure next. Drawn here; no network; prints on paper, and reads
// without its small script.

#include <string>

#include "config/model_file.hpp"
#include "model/diagnose/diagnose.hpp"
#include "model/diagnose/verdict_text.hpp"

namespace fogbench::model {

/// `words`: verdict_in_words of it. `model`: as it came. `data_name`: what was diagnosed, for the
/// heading. At most some 2,000 points are drawn in each plot.
std::string diagnosis_html(const Diagnosis& diagnosis, const VerdictWords& words,
                           const config::ModelFile& model, const std::string& data_name);

}  // namespace fogbench::model
