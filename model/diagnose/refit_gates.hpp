#pragma once
// What a refit of a model with the effects that were found says of them: it leaves the grid on
// which the search chose.

#include <optional>
#include <vector>

#include "model/diagnose/diagnose.hpp"

namespace fogbench::model {

/// Coefficients and inner parameters. Where these are one number in these data (a saturation that
/// hardly bends), the coefficients are those at this value of the parameter, which is said to be
/// open (MissingEffect::inner_open).
void take_estimates(const FitResult& refit, MissingEffect& missing);

/// The last effect that has no coefficient beyond its expanded uncertainty, or whose rung of the
/// ladder predicts left-out rows worse than the one below (the ladder's first: the model as it
/// came); nothing: there is none.
std::optional<Refused> refused_by_refit(const std::vector<MissingEffect>& missing,
                                        const std::vector<LadderStep>& ladder,
                                        const Library& library);

}  // namespace fogbench::model
