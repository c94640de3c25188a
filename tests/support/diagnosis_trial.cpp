#include "tests/support/diagnosis_trial.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fogbench::tests {
namespace {

constexpr std::size_t kMostNames = 3;  // of a set that still helps

/// The usual first model of the design, without what is hidden.
std::vector<std::string> base_for(const DiagnosisCase& what) {
  std::vector<std::string> base = usual_base(what.design);
  for (const std::string& id : what.hidden) std::erase(base, id);
  return base;
}

bool holds(const std::vector<std::string>& set, const std::string& name) {
  return std::find(set.begin(), set.end(), name) != set.end();
}

/// Which hidden effects can be given a set of their own: at most two of each, so trying both
/// orders is enough.
std::size_t matched(const std::vector<std::vector<std::string>>& sets,
                    std::vector<std::string> hidden) {
  std::size_t best = 0;
  std::sort(hidden.begin(), hidden.end());
  do {
    std::vector<bool> used(sets.size(), false);
    std::size_t count = 0;
    for (const std::string& id : hidden) {
      for (std::size_t i = 0; i < sets.size(); ++i) {
        if (used[i] || !holds(sets[i], id)) continue;
        used[i] = true;
        ++count;
        break;
      }
    }
    best = std::max(best, count);
  } while (std::next_permutation(hidden.begin(), hidden.end()));
  return best;
}

}  // namespace

std::string DiagnosisCase::name() const {
  std::string truth = hidden.empty() ? "nothing" : fmt::format("{}", fmt::join(hidden, "+"));
  if (shape == Shape::kOther) truth += "~other";
  std::string out = fmt::format("{}/{}/{}/s{:g}/{}", part, name_of(design), noise, s, truth);
  return variant.empty() ? out : out + "/" + variant;
}

std::uint64_t seed_of(const DiagnosisCase& what, std::uint64_t number) {
  std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a
  for (const char c : what.name() + "#" + std::to_string(number)) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  }
  return hash;
}

std::string_view name_of(Outcome outcome) {
  constexpr std::array<std::string_view, kOutcomes> kNames{
      "right", "right in a set", "large set",   "set without truth", "wrong name",
      "extra", "part only",      "unexplained", "or another shape",  "adequate"};
  return kNames[static_cast<std::size_t>(outcome)];
}

std::string contradiction_in(const model::Diagnosis& d) {
  constexpr double kRounding = 1.02, kByChance = 1.25, kNear = 1.6, kPlain = 6.0, kRare = 2e-3;
  for (std::size_t i = 1; i < d.ladder.size(); ++i) {
    if (d.ladder[i].rms > kRounding * d.ladder[i - 1].rms) return "the RMS rises with an effect";
  }
  if (d.noise_floor > kByChance * d.ladder.back().rms) return "the noise floor is above the RMS";
  if (d.verdict == model::Verdict::kNothingMissing) {
    for (const model::Region& region : d.before.regions) {
      if (std::abs(region.z) > kPlain && region.p_family_wise < kRare)
        return "adequate beside a misfit";
    }
  }
  if (d.verdict != model::Verdict::kMissingEffect) return {};
  for (const model::MissingEffect& m : d.missing) {
    if (m.found.inner_at_edge) return m.found.effect + " is named at the edge of its range";
    if (m.found.heldout.folds > 0 && 2 * m.found.heldout.better <= m.found.heldout.folds) {
      return m.found.effect + " is named, but predicts nothing";
    }
    bool stands = false, known = false;
    for (const model::Estimate& e : m.estimates) {
      if (e.inner || !std::isfinite(e.standard_error)) continue;
      known = true;
      stands = stands || std::abs(e.value) >= e.coverage_factor * e.standard_error;
    }
    if (known && !stands) return m.found.effect + " is named, but may be zero";
  }
  if (d.ladder.back().heldout_rms > kNear * d.noise_floor) return "named, and far from the floor";
  return {};
}

Outcome judge(const Answer& answer, const std::vector<std::string>& hidden) {
  const bool outside = !hidden.empty() && hidden.front().starts_with("outside_");
  if (answer.verdict == model::Verdict::kNothingMissing) return Outcome::kAdequate;
  if (answer.verdict == model::Verdict::kUnexplained) return Outcome::kUnexplained;
  if (outside && !answer.or_shape.empty()) return Outcome::kHedged;
  std::size_t widest = 0;
  for (const auto& set : answer.sets) widest = std::max(widest, set.size());
  const std::size_t right = matched(answer.sets, hidden);
  const bool or_noise = std::all_of(answer.sets.begin(), answer.sets.end(),
                                    [](const auto& set) { return holds(set, "random_walk"); });
  if (hidden.empty() && or_noise) return Outcome::kRightInSet;
  if (right == 0) {
    return widest > 1 ? Outcome::kSetWithoutTruth : Outcome::kWrongName;
  }
  if (answer.sets.size() > right) return Outcome::kExtra;
  if (right < hidden.size()) return Outcome::kPartOnly;
  if (widest > kMostNames) return Outcome::kLargeSet;
  return widest > 1 ? Outcome::kRightInSet : Outcome::kRight;
}

std::shared_ptr<const ForeignBench> TrialMaker::bench(const DiagnosisCase& what) {
  const std::vector<std::string> base = base_for(what);
  const std::string key =
      fmt::format("{}/{}/{}", name_of(what.design), what.noise, fmt::join(base, "+"));
  const std::lock_guard lock(mutex_);
  auto& known = benches_[key];
  if (!known) {
    known = std::make_shared<ForeignBench>(what.design, foreign_noise(what.noise), base);
  }
  return known;
}

Trial TrialMaker::make(const DiagnosisCase& what, std::uint64_t number) {
  const auto own_bench = bench(what);
  Trial out{.seed = seed_of(what, number), .hidden = {}, .table = {}, .quiet = {}, .model = {}};
  std::mt19937_64 engine(out.seed);
  for (const std::string& id : what.hidden) {
    const ForeignEffect effect = drawn_effect(id, what.shape, own_bench->worlds().front(), engine);
    out.hidden.push_back(own_bench->at_ratio(effect, what.s));
  }
  out.table = own_bench->table(out.hidden, what.columns, engine());
  if (what.quiet_hours > 0.0) {
    out.quiet = std::make_unique<model::Table>(
        static_record(foreign_noise(what.noise), what.quiet_hours, engine()));
  }
  out.model.name = "foreign bench";
  out.model.reference_temperature_c = kLaboratory;
  for (const std::string& id : own_bench->base()) {
    out.model.terms.push_back({});
    out.model.terms.back().effect = id;
  }
  return out;
}

Answer answer_of(const Trial& trial) {
  model::DiagnoseOptions options;
  options.quiet = trial.quiet.get();
  const auto diagnosis = model::diagnose(trial.table, trial.model, options);
  Answer out;
  if (!diagnosis) {
    out.verdict = model::Verdict::kMissingEffect;
    out.sets = {{"error: " + diagnosis.error().message}};
    out.says = out.sets[0][0];
    return out;
  }
  out.verdict = diagnosis->verdict;
  out.contradiction = contradiction_in(*diagnosis);
  std::vector<std::string> names;
  for (const model::MissingEffect& missing : diagnosis->missing) {
    std::vector<std::string> set{std::string(missing.found.effect)};
    for (const model::Rival& rival : missing.found.rivals) set.push_back(rival.effect);
    if (out.or_shape.empty()) out.or_shape = missing.found.or_shape;
    std::string name = fmt::format("{}", fmt::join(set, " or "));
    if (!missing.found.or_shape.empty()) name += " or shape " + missing.found.or_shape;
    names.push_back(std::move(name));
    out.sets.push_back(std::move(set));
  }
  if (out.sets.empty()) out.sets = diagnosis->ambiguous;  // the slow effects, or a random walk
  out.says = fmt::format("{}: {} (p {:.2g})", model::name_of(out.verdict), fmt::join(names, " + "),
                         diagnosis->p_adequate);
  if (out.verdict == model::Verdict::kUnexplained) {
    if (!diagnosis->unexplained.suggestion.empty()) {
      out.formula_floors = diagnosis->unexplained.heldout_rms / diagnosis->noise_floor;
    }
    out.says += fmt::format(" left p {:.2g} on {}, {}", diagnosis->unexplained.p_value,
                            fmt::join(diagnosis->unexplained.depends_on, ","),
                            diagnosis->unexplained.suggestion);
  }
  return out;
}

}  // namespace fogbench::tests
