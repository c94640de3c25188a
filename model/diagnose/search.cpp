#include "model/diagnose/search.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "model/diagnose/stage.hpp"
#include "model/fit/gls.hpp"
#include "model/fit/reduction.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A rival is dropped when its own world produces the leader's lead in less than this share of
// draws; a shadow speaks against the leader below kOutside.
constexpr double kRivalKept = 0.01;
constexpr double kOutside = 0.003;
// Each takes a simulation; who needs more has learned that he cannot tell.
constexpr std::size_t kMostRivals = 8;
// A shape that is the effect itself in these data, but for rounding, is ahead by less than this.
constexpr double kClearlyAhead = 2.0;
// Rivals further behind than this are not simulated: exp(-12) of the leader's likelihood.
constexpr double kTooFarBehind = 24.0;
// A slow effect is told from a random walk only below this p-value.
constexpr double kBeyondWalk = 2e-3;
// An effect may take this many further values of its inner parameter before what is left counts as
// something else.
constexpr std::size_t kMostFurtherShapes = 3;
// An added effect stays when dropping it is refuted at this level.
constexpr double kStays = 0.02;
constexpr int kMostChanges = 8;
// Where more leaders than this fail the gates, none of the catalogue is the truth.
constexpr std::size_t kMostRefused = 4;
// A stage holds the whitened library under each noise shape.
constexpr std::size_t kMostStages = 5;
// Of the held-out cost, twice a log-likelihood: rows that took no part in the fit are exp(3),
// twenty times, as likely with the effect as without it.
constexpr double kLeastGain = 6.0;

MatrixXd joined(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd out(a.rows(), a.cols() + b.cols());
  out << a, b;
  return out;
}

/// All that a found effect adds to the base: itself with its memory's beginnings, the inner
/// parameter's tangent, and what its other shapes differ by: which of them is the real one is not
/// known to the last digit, and the difference is no second effect.
MatrixXd columns_of(const Found& found, const Candidate& candidate) {
  const auto own = [&](std::size_t shape, double inner) -> MatrixXd {
    return candidate.shapes[shape](inner).leftCols(candidate.own);
  };
  MatrixXd out = candidate.shapes[found.shape](found.inner);
  if (candidate.parameter) {
    // An instant moves by rows, everything else smoothly.
    const double step =
        candidate.instant() ? 0.5 * candidate.spacing(found.inner) : 1e-3 * std::abs(found.inner);
    out =
        joined(out, (own(found.shape, found.inner + step) - own(found.shape, found.inner - step)) /
                        (2.0 * step));
  }
  for (std::size_t other = 0; other < candidate.shapes.size(); ++other) {
    if (other != found.shape) out = joined(out, own(other, found.inner));
  }
  for (const Block& more : found.more) out = joined(out, candidate.shapes[more.shape](more.inner));
  return out;
}

class Search {
 public:
  Search(const SearchInput& input, const SearchOptions& options)
      : input_(input), options_(options) {}

  SearchResult run() {
    do {
      // What led beside an effect that has been refused since says nothing of those that come.
      result_.outside_shape.clear();
      result_.p_outside = 1.0;
      while (found().size() < options_.most_effects && step()) {
      }
      judge_all();
    } while (!pass_gates());
    for (Found& f : found()) {
      Stage& stage = stage_without(&f);
      find_rivals(f, stage);
      face_shadows(f, stage);
    }
    doubt_sums_of_one_variable();
    return std::move(result_);
  }

 private:
  std::vector<Found>& found() { return result_.found; }
  const std::vector<Found>& found() const { return result_.found; }

  /// The state with all found effects but one in the base. Those of late are kept: a search that
  /// goes on without a refused effect comes the same way again.
  Stage& stage_without(const Found* except) {
    std::vector<double> key;
    for (const Found& f : found()) {
      if (&f == except) continue;
      key.push_back(static_cast<double>(f.candidate));
      key.push_back(static_cast<double>(f.shape));
      key.push_back(f.inner);
      for (const Block& more : f.more) key.push_back(static_cast<double>(more.first));
      key.push_back(-1.0);
    }
    const auto known = std::find_if(stages_.begin(), stages_.end(),
                                    [&](const auto& kept) { return kept.first == key; });
    if (known != stages_.end()) {
      std::rotate(known, known + 1, stages_.end());
    } else {
      if (stages_.size() == kMostStages) stages_.erase(stages_.begin());
      stages_.emplace_back(
          std::move(key),
          std::make_unique<Stage>(input_, base_with(input_, found(), except), options_.seed));
    }
    return *stages_.back().second;
  }

  /// Adds one effect, or a further shape to one that is there; false at the end.
  bool step() {
    if (input_.y.size() - base_with(input_, found()).cols() < kFewestFreeRows) return false;
    Stage& stage = stage_without(nullptr);
    if (refused_.size() > kMostRefused || !leads_to_a_name(stage)) return look_outside(stage);
    const Index best = stage.leader(refused_);
    const double p = stage.p_value(best);
    result_.p_of_step.push_back(p);
    if (p > level()) {
      result_.bounds = stage.bounds();
      std::erase_if(result_.bounds, [&](const Bound& bound) {
        return std::any_of(found().begin(), found().end(),
                           [&](const Found& f) { return f.effect == bound.effect; });
      });
      return look_outside(stage);
    }
    if (extend_found(stage, best)) return true;
    const auto candidate = static_cast<std::size_t>(best);
    if (is_found(candidate)) return false;
    found().push_back({.candidate = candidate,
                       .effect = stage.candidate(best).name,
                       .shape = stage.detector().best_block(best).shape,
                       .inner = stage.refined(best),
                       .p_value = p,
                       .inner_at_edge = stage.beyond_range(best)});
    return true;
  }

  /// No effect is left to be found: is there still a shape that none has, or one that could not be
  /// named? Always false: the end.
  bool look_outside(const Stage& stage) {
    for (const std::size_t c : refused_) {
      const auto refused = static_cast<Index>(c);
      if (!stage.detector().testable(refused) || is_found(c)) continue;
      hold_outside(stage.candidate(refused).name, stage.p_value(refused), level());
    }
    if (stage.shadows().empty()) return false;
    const Index best = stage.best(stage.shadows());
    hold_outside(stage.candidate(best).name, stage.p_value(best),
                 found().empty() ? options_.outside_level : kLeftBesideFound);
    return false;
  }

  /// What an effect needs to be added to those that are found.
  double level() const { return found().empty() ? options_.first_level : options_.later_level; }

  /// An effect is left that was not refused.
  bool leads_to_a_name(const Stage& stage) const {
    return std::any_of(stage.effects().begin(), stage.effects().end(), [&](Index c) {
      return std::find(refused_.begin(), refused_.end(), static_cast<std::size_t>(c)) ==
             refused_.end();
    });
  }

  /// The shadows, and the effects that were refused: what could not be named may still be the
  /// truth.
  std::vector<Index> with_refused(const Stage& stage, Index except) const {
    std::vector<Index> out = stage.shadows();
    for (const std::size_t c : refused_) {
      const auto other = static_cast<Index>(c);
      if (other != except && stage.detector().testable(other)) out.push_back(other);
    }
    return out;
  }

  void hold_outside(const std::string& shape, double p, double level) {
    if (p > level || p >= result_.p_outside) return;
    result_.outside_shape = shape;
    result_.p_outside = p;
  }

  bool is_found(std::size_t candidate) {
    return std::any_of(found().begin(), found().end(),
                       [&](const Found& f) { return f.candidate == candidate; });
  }

  /// Gives the rest to an effect that was found already, with another value of its inner parameter,
  /// where that explains the rest as well as the leader does. A second jump is more than the effect
  /// of one jump: something came and went, and the jump is refused. Something slow may be the
  /// truth, of which one jump was the first half.
  bool extend_found(Stage& stage, Index leader) {
    for (std::size_t at = 0; at < found().size(); ++at) {
      Found& f = found()[at];
      const auto own = static_cast<Index>(f.candidate);
      const Candidate& candidate = stage.candidate(own);
      if (f.more.size() >= kMostFurtherShapes || !stage.detector().testable(own)) continue;
      if (stage.at_edge(own)) continue;  // there it is another effect, or two
      const double lag = stage.lead()[leader] - stage.lead()[own];
      const bool as_well =
          own == leader || (!candidate.instant() && lag < kTooFarBehind &&
                            stage.plausible(own, lag, stage.effects()) > kRivalKept);
      if (!as_well) continue;
      if (candidate.instant()) {
        refuse({at, Refusal::kComesAndGoes});
      } else {
        f.more.push_back(stage.detector().best_block(own));
      }
      return true;
    }
    return false;
  }

  /// Looks at an addition with all the others in the base: drops it when it is not needed any more,
  /// takes another effect in its place when that one leads now. False when the list changed.
  bool judge(std::size_t at, bool may_change) {
    Found& f = found()[at];
    Stage& stage = stage_without(&f);
    const auto own = static_cast<Index>(f.candidate);
    const bool testable = stage.detector().testable(own);
    if (!testable || (may_change && stage.p_value_alone(own) > kStays)) {
      found().erase(found().begin() + static_cast<std::ptrdiff_t>(at));
      return false;
    }
    const Index leader = stage.leader(refused_);
    if (may_change && leader != own && !is_found(static_cast<std::size_t>(leader))) {
      f = {.candidate = static_cast<std::size_t>(leader),
           .effect = stage.candidate(leader).name,
           .shape = stage.detector().best_block(leader).shape,
           .inner = stage.refined(leader)};
      return false;
    }
    f.shape = stage.detector().best_block(own).shape;
    f.inner = stage.refined(own);
    f.inner_at_edge = stage.beyond_range(own);
    f.p_value = stage.p_value(own);
    return true;
  }

  /// Each verdict rests on the other effects; a change starts the round again, a few times at most.
  void judge_all() {
    int changes = 0;
    for (std::size_t i = 0; i < found().size();) {
      i = judge(i, changes < kMostChanges) ? i + 1 : 0;
      changes += i == 0 ? 1 : 0;
    }
  }

  /// A name needs all of these: its inner parameter lies inside its range, its coefficient stands
  /// beside those of all the others, rows that took no part in the fit are predicted better with
  /// it, and a refit that leaves the grid finds no fault. What fails is refused for good, one at a
  /// time, the last found first, and the search goes on without it. False when the list changed.
  bool pass_gates() {
    if (const auto noise = gls(input_.shapes(), base_with(input_, found()), input_.y)) {
      for (Found& f : found()) f.heldout = vote_on(f, noise->noise.noise);
      for (std::size_t i = found().size(); i-- > 0;) {
        const Refusal why = why_refused(found()[i]);
        if (why != Refusal::kNone) return refuse({i, why});
      }
    }
    const auto refused = options_.refit ? options_.refit(found()) : std::nullopt;
    return !refused || refuse(*refused);
  }

  bool refuse(const Refused& refused) {
    Found& f = found()[refused.at];
    f.refusal = refused.why;
    refused_.push_back(f.candidate);
    result_.refused.push_back(std::move(f));
    found().erase(found().begin() + static_cast<std::ptrdiff_t>(refused.at));
    return false;
  }

  /// Noise that wanders predicts rows from their neighbours as well as a slow effect does. So where
  /// nothing is gained beside it, the model's own predictions are asked, which know no neighbours;
  /// they must gain twice as much, for what wanders is not independent.
  HeldoutVote vote_on(const Found& f, const NoiseCoefficients& noise) const {
    const Candidate& candidate = input_.tried().candidates[f.candidate];
    const MatrixXd its = candidate.shapes[f.shape](f.inner);
    const MatrixXd others = base_with(input_, found(), &f);
    const MatrixXd with = full_rank(joined(others, its));
    const MatrixXd without = full_rank(joined(others, its.rightCols(its.cols() - candidate.own)));
    const auto vote = [&](const NoiseCoefficients& under) {
      const auto votes =
          heldout_votes(input_.windows, under, with, {without}, input_.y, input_.bench_rows);
      return votes.empty() ? HeldoutVote{} : votes.front();
    };
    const HeldoutVote beside_noise = vote(noise);
    if (beside_noise.folds == 0 || predicts(beside_noise, kLeastGain)) return beside_noise;
    const HeldoutVote alone =
        vote({.angle_random_walk_deg_per_sqrt_h = noise.angle_random_walk_deg_per_sqrt_h});
    if (predicts(alone, 2.0 * kLeastGain)) return alone;
    // A drift or a warm-up is one of a kind in a run: no part of it is like another.
    return candidate.slow && !candidate.instant() ? HeldoutVote{} : beside_noise;
  }

  static bool predicts(const HeldoutVote& vote, double least_gain) {
    return 2 * vote.better > vote.folds && vote.gain > least_gain;
  }

  Refusal why_refused(const Found& f) const {
    if (f.inner_at_edge) return Refusal::kAtEdge;
    if (!stands(f)) return Refusal::kNotDistinguished;
    if (f.heldout.folds == 0 || predicts(f.heldout, kLeastGain) || or_walk(f)) {
      return Refusal::kNone;
    }
    return Refusal::kNotPredicting;
  }

  /// A slow effect that a random walk may be as well, which is all that left-out rows could tell.
  bool or_walk(const Found& f) const {
    return input_.tried().candidates[f.candidate].slow && f.p_value > kBeyondWalk;
  }

  /// A coefficient of the effect is larger than its expanded uncertainty at this value of its inner
  /// parameter, all the others in the model. (With the inner parameter free the two are but one
  /// number in the limit where the effect has one shape: a saturation that hardly bends.)
  bool stands(const Found& f) const {
    const Candidate& candidate = input_.tried().candidates[f.candidate];
    const MatrixXd x = joined(candidate.shapes[f.shape](f.inner), base_with(input_, found(), &f));
    const auto solved = gls(input_.shapes(), x, input_.y);
    if (!solved) return true;  // too few rows to tell
    bool known = false;
    for (Index i = 0; i < candidate.own; ++i) {
      const double variance = solved->covariance(i, i);
      if (!std::isfinite(variance)) continue;
      known = true;
      if (std::abs(solved->beta[i]) > solved->coverage_factor * std::sqrt(variance)) return true;
    }
    return !known;
  }

  void find_rivals(Found& f, Stage& stage) {
    const auto own = static_cast<Index>(f.candidate);
    std::vector<std::pair<double, Index>> near;
    for (const Index c : stage.effects()) {
      const double lag = stage.lead()[own] - stage.lead()[c];
      if (c == own || is_found(static_cast<std::size_t>(c)) || lag > kTooFarBehind) continue;
      // Another form of it that contains it, and would lead if it were needed.
      if (stage.candidate(c).extends == f.effect) continue;
      if (!stage.stands(c)) continue;
      near.emplace_back(lag, c);
    }
    std::sort(near.begin(), near.end());
    if (near.size() > kMostRivals) near.resize(kMostRivals);
    std::vector<std::pair<double, std::string>> behind;
    for (const auto& [lag, c] : near) {
      // Where its own simpler limit does nearly as well, that may be meant.
      const bool near_limit =
          stage.candidate(c).name == stage.candidate(own).limit && lag < kNearlyAsWell;
      if (near_limit || stage.plausible(c, lag, stage.effects()) > kRivalKept) {
        behind.emplace_back(std::max(lag, 0.0), stage.candidate(c).name);
      }
    }
    if (or_walk(f)) behind.emplace_back(0.0, "random_walk");
    double total = 1.0;
    for (const auto& [lag, name] : behind) total += std::exp(-0.5 * lag);
    f.probability = 1.0 / total;
    std::sort(behind.begin(), behind.end());
    for (const auto& [lag, name] : behind) {
      f.rivals.push_back({name, std::exp(-0.5 * lag) / total});
    }
  }

  /// A shape from outside the catalogue that leads by more than the effect's own world allows says
  /// that the effect is not the truth.
  void face_shadows(Found& f, Stage& stage) {
    const auto own = static_cast<Index>(f.candidate);
    std::vector<Index> shadows = with_refused(stage, own);
    // That one jump is not two was settled step by step, where the jump's place is exact.
    if (stage.candidate(own).instant()) {
      std::erase_if(shadows, [&](Index c) { return stage.candidate(c).pulse; });
    }
    if (shadows.empty()) return;
    const Index shadow = stage.best(shadows);
    const double ahead = stage.lead()[shadow] - stage.lead()[own];
    const double p = ahead > 0.0 ? stage.plausible(own, ahead, shadows) : 1.0;
    hold_outside(stage.candidate(shadow).name, p, kOutside);
    if (p <= kOutside) return;
    f.shape_leads = ahead > kClearlyAhead;
    if (ahead > 0.0 ||
        (-ahead < kTooFarBehind && stage.plausible(shadow, -ahead, stage.effects()) > kRivalKept)) {
      f.or_shape = stage.candidate(shadow).name;
    }
  }

  /// Two curves over one variable are one other curve as well, and nothing in the data says which.
  void doubt_sums_of_one_variable() {
    for (Found& f : found()) {
      const std::string variable = input_.tried().candidates[f.candidate].curve_over;
      if (variable.empty()) continue;
      const auto curves = std::count_if(found().begin(), found().end(), [&](const Found& other) {
        return input_.tried().candidates[other.candidate].curve_over == variable;
      });
      if (curves < 2) continue;
      f.or_shape = "one other function of " + variable;
      f.shape_leads = true;
    }
  }

  const SearchInput& input_;
  const SearchOptions& options_;
  SearchResult result_;
  std::vector<std::size_t> refused_;
  std::vector<std::pair<std::vector<double>, std::unique_ptr<Stage>>> stages_;  ///< latest last
};

}  // namespace

MatrixXd base_with(const SearchInput& input, const std::vector<Found>& found, const Found* except) {
  MatrixXd base = input.base;
  for (const Found& f : found) {
    if (&f != except) base = joined(base, columns_of(f, input.tried().candidates[f.candidate]));
  }
  return full_rank(base);
}

MatrixXd full_rank(const MatrixXd& columns) {
  constexpr double kDependent = 1e-8;
  return columns(Eigen::all, independent_columns(columns, columns.cols(), kDependent));
}

SearchResult search(const SearchInput& input, const SearchOptions& options) {
  return Search(input, options).run();
}

}  // namespace fogbench::model
