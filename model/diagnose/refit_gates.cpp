#include "model/diagnose/refit_gates.hpp"

#include <algorithm>
#include <cmath>

namespace fogbench::model {
namespace {

// An effect that is there makes predictions of rows left out no worse than this, chance included.
constexpr double kWorse = 1.05;

bool stands(const Estimate& e) {
  return std::abs(e.value) > e.coverage_factor * e.standard_error;
}

}  // namespace

void take_estimates(const FitResult& refit, MissingEffect& missing) {
  bool any_stands = false, any_inner = false;
  for (const Estimate& e : refit.estimates) {
    const bool its = std::any_of(
        missing.terms.begin(), missing.terms.end(),
        [&](const std::string& id) { return e.name == id || e.name.starts_with(id + "."); });
    if (!its) continue;
    missing.estimates.push_back(e);
    any_inner = any_inner || (e.inner && !e.held);
    any_stands = any_stands || (!e.inner && stands(e));
  }
  if (any_stands || !any_inner) return;
  missing.inner_open = true;
  for (Estimate& e : missing.estimates) {
    if (!e.held) e.standard_error = e.error_at_inner;
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
