#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/diagnose/search.hpp"
#include "model/diagnose/working_table.hpp"
#include "model/fit/fit.hpp"

namespace fogbench::model {

/// The hysteresis effects that were found, refused, or could not be told from what was found.
std::vector<std::string> hystereses_of(const SearchResult& result);

/// The form of a hysteresis effect (effects/loop.hpp) that rows left out of the fit pay for, beside
/// the terms of `model`: from one play on, more parts of the density have to predict them clearly
/// better. With the inner parameters of its fit. Nothing where one play does as well, or the
/// weights are not of one sign.
std::optional<config::ModelTerm> best_loop(std::string_view effect, const WorkingTable& table,
                                           const config::ModelFile& model,
                                           const FitOptions& options);

/// No weight of the term is of the other sign than most, beyond its expanded uncertainty.
bool of_one_sign(const FitResult& fit, std::string_view term);

}  // namespace fogbench::model
