#include "model/fit/unexcited.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/effects/catalogue.hpp"
#include "model/effects/excitation.hpp"

namespace fogbench::model {
namespace {

/// Whether the estimate, by its place among all of the design, belongs to the term.
bool belongs(const Design& design, std::size_t estimate, std::size_t term) {
  const std::size_t own = design.own_columns();
  if (estimate < own) return design.columns()[estimate].term == term;
  const std::vector<std::size_t>& terms = design.parameters()[estimate - own].terms;
  return std::find(terms.begin(), terms.end(), term) != terms.end();
}

/// Free, known, and within its uncertainty.
bool says_nothing(const Estimate& e) {
  return !e.held && std::isfinite(e.value) &&
         !(std::abs(e.value) > e.coverage_factor * e.standard_error);
}

}  // namespace

std::vector<UnexcitedTerm> unexcited_terms(const Signals& signals, const config::ModelFile& model,
                                           const Design& design,
                                           const std::vector<Estimate>& estimates) {
  std::vector<UnexcitedTerm> out;
  for (std::size_t term = 0; term < model.terms.size(); ++term) {
    const config::ModelTerm& asked = model.terms[term];
    const Effect* effect = asked.expression ? nullptr : find_effect(asked.effect);
    if (effect == nullptr) continue;
    bool nothing = true;
    for (std::size_t i = 0; i < design.own_columns(); ++i) {
      nothing = nothing && (!belongs(design, i, term) || says_nothing(estimates[i]));
    }
    if (!nothing) continue;
    std::string because = unexcited_because(effect->info(), signals);
    if (!because.empty()) out.push_back({term, std::move(because)});
  }
  return out;
}

config::ModelFile without_terms(const config::ModelFile& model,
                                const std::vector<UnexcitedTerm>& terms) {
  config::ModelFile rest = model;
  for (auto left_out = terms.rbegin(); left_out != terms.rend(); ++left_out) {
    rest.terms.erase(rest.terms.begin() + static_cast<std::ptrdiff_t>(left_out->term));
  }
  return rest;
}

FitResult with_unexcited(FitResult fitted, const std::vector<UnexcitedTerm>& terms,
                         const Design& design, const std::vector<Estimate>& estimates) {
  std::vector<Estimate> all;
  std::vector<Eigen::Index> place;  // among all that are not held, of those that were fitted
  std::size_t next = 0;
  Eigen::Index free = 0;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const auto left_out = std::find_if(terms.begin(), terms.end(), [&](const UnexcitedTerm& term) {
      return belongs(design, i, term.term);
    });
    if (left_out != terms.end()) {
      Estimate none = estimates[i];
      none.value = none.standard_error = none.error_at_inner = kMissing;
      none.unexcited = left_out->because;
      all.push_back(std::move(none));
      ++free;
      continue;
    }
    all.push_back(fitted.estimates[next++]);
    if (all.back().held) continue;
    place.push_back(free++);
  }
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(free, free, kMissing);
  covariance(place, place) = fitted.covariance;
  fitted.estimates = std::move(all);
  fitted.covariance = std::move(covariance);
  for (const UnexcitedTerm& term : terms) {
    fitted.warnings.push_back(fmt::format("{} is left out: these data do not excite it ({})",
                                          design.term_name(term.term), term.because));
  }
  return fitted;
}

}  // namespace fogbench::model
