#include "model/diagnose/loop_choice.hpp"

#include <algorithm>
#include <cmath>

#include "model/diagnose/heldout.hpp"
#include "model/effects/catalogue.hpp"
#include "model/effects/loop.hpp"

namespace fogbench::model {
namespace {

// A form of more unknowns has to miss rows left out by less than this share.
constexpr double kPays = 0.93;
// More parts than these describe no loop better than a noise of a hundredth of it shows.
constexpr std::size_t kMostPartsTried = 5;
// Each unknown of a form takes so many rows.
constexpr std::size_t kRowsOfUnknown = 6;
// So many parts more that bring nothing end the trials.
constexpr std::size_t kInVain = 2;

}  // namespace

std::vector<std::string> hystereses_of(const SearchResult& result) {
  std::vector<std::string> out;
  const auto add = [&](const std::string& name) {
    const bool known = std::find(out.begin(), out.end(), name) != out.end();
    if (!known && !effects::loops_of(name).empty()) out.push_back(name);
  };
  for (const auto* list : {&result.found, &result.refused}) {
    for (const Found& f : *list) {
      add(f.effect);
      for (const Rival& rival : f.rivals) add(rival.effect);
    }
  }
  return out;
}

bool of_one_sign(const FitResult& fit, std::string_view term) {
  double sum = 0.0;
  const auto weights = [&](const auto& each) {
    for (const Estimate& e : fit.estimates) {
      const bool own = e.name == term || e.name.starts_with(std::string(term) + ".");
      if (own && !e.inner && std::isfinite(e.value)) each(e);
    }
  };
  weights([&](const Estimate& e) { sum += e.value; });
  bool one = true;
  weights([&](const Estimate& e) {
    one = one && !(e.value * sum < 0.0 && std::abs(e.value) > e.coverage_factor * e.standard_error);
  });
  return one;
}

std::optional<config::ModelTerm> best_loop(std::string_view effect, const WorkingTable& table,
                                           const config::ModelFile& model,
                                           const FitOptions& options) {
  std::vector<const Effect*> tried = effects::loops_of(effect);
  tried.insert(tried.begin(), find_effect(effect));
  const auto rows = static_cast<std::size_t>(table.bench_rows());
  double least = HUGE_VAL;
  std::size_t parts = 0;
  std::optional<config::ModelTerm> best;
  for (const Effect* form : tried) {
    const EffectInfo& info = form->info();
    const std::size_t its = info.form_of.empty() ? 0 : info.columns.size();
    const bool too_few = kRowsOfUnknown * (its + info.parameters.size()) > rows;
    if (its > kMostPartsTried || its > parts + kInVain || too_few) break;
    config::ModelFile wider = model;
    wider.terms.emplace_back().effect = info.id;
    const auto fitted = fit(table.bench_with_history(), wider, options);
    if (!fitted || !of_one_sign(*fitted, info.id)) continue;
    // A term that is not in the fitted model is zero in these data.
    const auto& terms = fitted->fitted.terms;
    if (terms.empty() || terms.back().effect != info.id) continue;
    const double rms = heldout_rms(table.bench_with_history(), table.windows(), fitted->fitted,
                                   fitted->noise.noise);
    if (!(rms < kPays * least)) continue;
    least = rms;
    parts = its;
    if (its == 0) continue;
    best.emplace().effect = info.id;
    best->parameters = terms.back().parameters;
  }
  return best;
}

}  // namespace fogbench::model
