#include "model/diagnose/refit_gates.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// An effect that is there makes predictions of rows left out no worse than this, chance included.
constexpr double kWorse = 1.05;

bool stands(const Estimate& e) {
  return std::abs(e.value) > e.coverage_factor * e.standard_error;
}

}  // namespace

void take_estimates(const FitResult& refit, MissingEffect& missing) {
  std::vector<Index> at, inner;  // in the covariance, which holds what is free
  Index free = 0;
  bool any_stands = false;
  for (const Estimate& e : refit.estimates) {
    const bool its = std::any_of(
        missing.terms.begin(), missing.terms.end(),
        [&](const std::string& id) { return e.name == id || e.name.starts_with(id + "."); });
    if (its) {
      missing.estimates.push_back(e);
      at.push_back(e.held ? -1 : free);
      if (!e.inner) {
        any_stands = any_stands || stands(e);
      } else if (!e.held) {
        inner.push_back(free);
      }
    }
    free += e.held ? 0 : 1;
  }
  const MatrixXd& covariance = refit.covariance;
  if (any_stands || inner.empty() || inner.back() >= covariance.rows()) return;
  const Eigen::LLT<MatrixXd> together(covariance(inner, inner));
  if (together.info() != Eigen::Success) return;
  missing.inner_open = true;
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (at[i] < 0) continue;
    const Eigen::VectorXd shared = covariance(inner, at[i]);
    const double left = covariance(at[i], at[i]) - shared.dot(together.solve(shared));
    missing.estimates[i].standard_error =
        missing.estimates[i].inner ? kMissing : std::sqrt(std::max(0.0, left));
  }
}

std::optional<Refused> refused_by_refit(const std::vector<MissingEffect>& missing,
                                        const std::vector<LadderStep>& ladder,
                                        const Library& library) {
  for (std::size_t i = missing.size(); i-- > 0;) {
    bool any_stands = false, known = false;
    for (const Estimate& e : missing[i].estimates) {
      if (e.inner || !std::isfinite(e.standard_error)) continue;
      known = true;
      any_stands = any_stands || stands(e);
    }
    // Neighbouring weights of a loop share what is known of their sum.
    if (missing[i].loop && stands(missing[i].loop->remanence)) any_stands = true;
    if (known && !any_stands) return Refused{i, Refusal::kNotDistinguished};
    // With a slow effect the wandering of the noise makes that a matter of chance.
    const bool slow = library.candidates[missing[i].found.candidate].slow;
    if (!slow && missing[i].heldout_rms_after > kWorse * ladder[i].heldout_rms) {
      return Refused{i, Refusal::kNotPredicting};
    }
  }
  return {};
}

}  // namespace fogbench::model
