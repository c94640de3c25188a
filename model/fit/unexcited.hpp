#pragma once
// Terms of the catalogue that the table never excites. Their coefficients would be "4 +- 12", and
// what they are nearly inseparable from (a bias) as uncertain: they are left out of the fit.

#include <string>
#include <vector>

#include "config/model_file.hpp"
#include "model/fit/design.hpp"
#include "model/fit/fit.hpp"

namespace fogbench::model {

struct UnexcitedTerm {
  std::size_t term = 0;  ///< of the model and its design
  std::string because;   ///< "field_x_ut stays at one value"
};

/// `estimates` are those of the whole design. A term whose coefficient is beyond its expanded
/// uncertainty has shown itself, however little the signal moved, and held ones are not asked.
std::vector<UnexcitedTerm> unexcited_terms(const Signals& signals, const config::ModelFile& model,
                                           const Design& design,
                                           const std::vector<Estimate>& estimates);

/// The model without them.
config::ModelFile without_terms(const config::ModelFile& model,
                                const std::vector<UnexcitedTerm>& terms);

/// The fit of without_terms() with an estimate, not determined, for each of what was left out;
/// `estimates` are those of the whole design. A warning names each term.
FitResult with_unexcited(FitResult fitted, const std::vector<UnexcitedTerm>& terms,
                         const Design& design, const std::vector<Estimate>& estimates);

}  // namespace fogbench::model
