#pragma once
// The first step of a diagnosis by itself: is anything left beside a fitted model that noise does
// not explain? With the same draws as the diagnosis, so that whoever asks only this is told so
// whenever the diagnosis would go on to name something.

#include <algorithm>
#include <cstdint>
#include <string>

#include "config/result.hpp"
#include "model/diagnose/search.hpp"
#include "model/fit/fit.hpp"
#include "model/noise/noise_prior.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// How a false-alarm rate is shared out: to the effects, to shapes from outside the catalogue, to
/// the smooth functions of every variable and the innovations; and, where ranges are looked at
/// too, as much again as for the last to them.
inline constexpr double kShareOfEffects = 0.8, kShareOfShapes = 0.1, kShareOfSmooth = 0.1,
                        kShareOfRegions = 0.1;

struct FirstLook {
  bool looked = false;  ///< false: too few rows beside the terms
  double p_effects = 1.0, p_shapes = 1.0, p_smooth = 1.0;
  /// Probability that the random walk beside the model is one of such an instrument.
  double p_walk = 1.0;
  std::string looks_like;  ///< what has the least of these

  /// One p-value of all three, and of the walk, which a diagnosis doubts by itself.
  double p_value() const {
    return std::min({1.0, p_effects / kShareOfEffects, p_shapes / kShareOfShapes,
                     p_smooth / kShareOfSmooth, p_walk});
  }
};

/// `smooth`: make_smooth_library().
FirstLook look_at(const SearchInput& input, const Library& smooth, std::uint64_t seed);

/// The same beside a fit of the table, without the readings that it did not believe. Errors: those
/// of WorkingTable and of the design.
Result<FirstLook> first_look(const Table& table, const FitResult& fit, const NoisePrior& prior);

}  // namespace fogbench::model
