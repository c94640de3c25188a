#include "model/diagnose/search.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "model/diagnose/calibration.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kNullDraws = 499;
constexpr Index kNullDrawsManyRows = 199;
constexpr Index kManyRows = 700;
constexpr Index kRivalDraws = 299;
// A rival is dropped when its own world produces the leader's lead in less than this share of
// draws; a shadow convicts the leader below kOutside.
constexpr double kRivalKept = 0.05;
constexpr double kOutside = 0.01;
// Rivals further behind than this in Lambda are not simulated: exp(-20) of the leader's likelihood.
constexpr double kHopeless = 40.0;
// A slow effect is told from a random walk only below this p-value.
constexpr double kBeyondWalk = 2e-3;
// An effect may take this many further values of its inner parameter before what is left counts as
// something else.
constexpr std::size_t kMostShapes = 3;
// Backward check: an added effect stays when dropping it is refuted at this level.
constexpr double kStays = 0.02;

Index draws_for(Index rows) { return rows > kManyRows ? kNullDrawsManyRows : kNullDraws; }

MatrixXd joined(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd out(a.rows(), a.cols() + b.cols());
  out << a, b;
  return out;
}

MatrixXd base_with(const SearchInput& input, const std::vector<Found>& found,
                   const Found* except = nullptr) {
  MatrixXd base = input.base;
  for (const Found& f : found) {
    if (&f != except) base = joined(base, columns_of(f, input.signals));
  }
  return full_rank(base);
}

Library only(const Library& library, const std::string& name) {
  Library out;
  for (const Candidate& c : library.candidates) {
    if (c.name != name) continue;
    Candidate copy = c;
    Index width = 0;
    for (const Block& b : c.blocks) width += b.width;
    out.columns.resize(library.columns.rows(), width);
    Index at = 0;
    for (Block& b : copy.blocks) {
      out.columns.middleCols(at, b.width) = library.columns.middleCols(b.first, b.width);
      b.first = at;
      at += b.width;
    }
    out.candidates.push_back(std::move(copy));
  }
  return out;
}

/// Narrows the inner parameter around the grid's best point by golden section on Lambda.
void refine(Found& found, const Detector& detector, const Candidate& candidate,
            const Signals& signals) {
  if (found.inner.empty()) return;
  const auto& blocks = candidate.blocks;
  std::size_t at = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (blocks[i].inner == found.inner) at = i;
  }
  found.inner_at_edge = at == 0 || at + 1 == blocks.size();
  if (found.effect->info().parameters.front().name == "t0") {
    found.inner_at_edge = false;
    return;  // the likelihood of an instant is a staircase: the grid is its resolution
  }
  double low = blocks[at > 0 ? at - 1 : at].inner.front();
  double high = blocks[at + 1 < blocks.size() ? at + 1 : at].inner.front();
  const auto lambda = [&](double value) {
    return detector.lambda_of(finite_regressor(*found.effect, signals, std::vector{value}));
  };
  constexpr double kGolden = 0.381966;
  constexpr int kRounds = 12;
  double inside = found.inner.front(), best = lambda(inside);
  for (int i = 0; i < kRounds && high > low; ++i) {
    const double trial = high - inside > inside - low ? inside + kGolden * (high - inside)
                                                      : inside - kGolden * (inside - low);
    const double value = lambda(trial);
    if (value > best) {
      (trial > inside ? low : high) = inside;
      inside = trial;
      best = value;
    } else {
      (trial > inside ? high : low) = trial;
    }
  }
  found.inner = {inside};
}

struct Step {
  bool significant = false;
  double p_value = 1.0;
  Found found;
  std::string name;
  std::string outside_shape;
  double p_outside = 1.0;
};

/// Shares of the leader and its rivals by likelihood, each on its own noise scale.
void set_probabilities(Found& leader, std::vector<std::pair<double, std::string>> behind) {
  double total = 1.0;
  for (const auto& [lag, name] : behind) total += std::exp(-0.5 * lag);
  leader.probability = 1.0 / total;
  std::sort(behind.begin(), behind.end());
  for (const auto& [lag, name] : behind) {
    leader.rivals.push_back({name, std::exp(-0.5 * lag) / total});
  }
}

Step forward_step(const SearchInput& input, const Library& library, const MatrixXd& base,
                  double level, std::uint64_t seed, std::vector<Bound>* bounds) {
  const Detector detector(input.shapes, base, library, input.y);
  Calibration calibration(detector.lambdas(detector.draw(draws_for(input.y.size()), seed)));
  const VectorXd lead = calibration.lead(detector.observed());

  std::vector<Index> effects, shadows;
  for (Index c = 0; c < detector.candidates(); ++c) {
    if (!detector.testable(c)) continue;
    (library.candidates[static_cast<std::size_t>(c)].shadow ? shadows : effects).push_back(c);
  }
  Step step;
  if (effects.empty()) return step;
  const Index best = *std::max_element(effects.begin(), effects.end(), [&](Index a, Index b) {
    return lead[a] < lead[b];
  });
  step.p_value = calibration.p_value(lead[best], effects);
  step.significant = step.p_value <= level;
  if (!step.significant) {
    for (const Index c : effects) {
      const auto& candidate = library.candidates[static_cast<std::size_t>(c)];
      if (bounds == nullptr || candidate.effect == nullptr) continue;
      const auto coefficient = detector.coefficients(c);
      bounds->push_back({candidate.name,
                         (coefficient.value.cwiseAbs() + 1.96 * coefficient.standard_error).maxCoeff(),
                         std::string(candidate.effect->info().units.front())});
    }
    return step;
  }

  const auto& leader = library.candidates[static_cast<std::size_t>(best)];
  step.name = leader.name;
  step.found.effect = leader.effect;
  step.found.inner = detector.best_block(best).inner;
  step.found.p_value = step.p_value;

  const Draws noise = detector.draw(kRivalDraws, seed + 1, best);
  // P(another candidate leads `world` by at least `lag` in the world where `world` is the truth).
  const auto plausible = [&](Index world, double lag, const std::vector<Index>& others) {
    const MatrixXd leads = calibration.lead(detector.lambdas(noise, detector.fitted_signal(world)));
    Index reached = 0;
    for (Index b = 0; b < leads.cols(); ++b) {
      double top = leads(world, b);
      for (const Index c : others) top = std::max(top, leads(c, b));
      reached += top - leads(world, b) >= lag ? 1 : 0;
    }
    return static_cast<double>(reached) / static_cast<double>(leads.cols());
  };

  std::vector<std::pair<double, std::string>> behind;
  for (const Index c : effects) {
    const double lag = lead[best] - lead[c];
    if (c == best || lag > kHopeless) continue;
    if (plausible(c, lag, effects) > kRivalKept) {
      behind.emplace_back(std::max(lag, 0.0), library.candidates[static_cast<std::size_t>(c)].name);
    }
  }
  if (leader.slow && step.p_value > kBeyondWalk) {
    behind.emplace_back(0.0, "random_walk");
  }
  set_probabilities(step.found, std::move(behind));

  const auto shadow = std::max_element(shadows.begin(), shadows.end(), [&](Index a, Index b) {
    return lead[a] < lead[b];
  });
  if (shadow != shadows.end()) {
    const double ahead = lead[*shadow] - lead[best];
    const std::string& shape = library.candidates[static_cast<std::size_t>(*shadow)].name;
    const double p = ahead > 0.0 ? plausible(best, ahead, shadows) : 1.0;
    if (p < kOutside) {
      step.outside_shape = shape;
      step.p_outside = p;
    } else if (-ahead < kHopeless &&
               (ahead > 0.0 || plausible(*shadow, -ahead, effects) > kRivalKept)) {
      step.found.or_shape = shape;
    }
  }
  if (leader.effect != nullptr) refine(step.found, detector, leader, input.signals);
  return step;
}

/// Each found effect's inner parameter again, with the others in the base.
void refine_all(const SearchInput& input, const Library& library, std::vector<Found>& found) {
  for (Found& f : found) {
    if (f.inner.empty() || f.effect == nullptr) continue;
    const MatrixXd base = base_with(input, found, &f);
    const Library own = only(library, std::string(f.effect->info().id));
    const Detector detector(input.shapes, base, own, input.y);
    if (!detector.testable(0)) continue;
    f.inner = detector.best_block(0).inner;
    refine(f, detector, own.candidates.front(), input.signals);
  }
}

/// Drops added effects that the later ones have made superfluous; true when one was dropped.
bool drop_superfluous(const SearchInput& input, const Library& library, std::vector<Found>& found,
                      std::uint64_t seed) {
  for (std::size_t i = 0; i + 1 < found.size(); ++i) {
    const MatrixXd base = base_with(input, found, &found[i]);
    const Library own = only(library, std::string(found[i].effect->info().id));
    const Detector detector(input.shapes, base, own, input.y);
    if (detector.testable(0)) {
      const Calibration calibration(detector.lambdas(detector.draw(kNullDrawsManyRows, seed)));
      const double lead = calibration.lead(detector.observed())[0];
      if (calibration.p_value(lead, {0}) <= kStays) continue;
    }
    found.erase(found.begin() + static_cast<std::ptrdiff_t>(i));
    return true;
  }
  return false;
}

}  // namespace

MatrixXd columns_of(const Found& found, const Signals& signals) {
  const MatrixXd value = finite_regressor(*found.effect, signals, found.inner);
  if (found.inner.empty() || found.effect->info().parameters.front().name == "t0") return value;
  const double a = found.inner.front();
  const double h = 1e-3 * std::abs(a);
  const MatrixXd up = finite_regressor(*found.effect, signals, std::vector{a + h});
  const MatrixXd down = finite_regressor(*found.effect, signals, std::vector{a - h});
  MatrixXd out = joined(value, (up - down) / (2.0 * h));
  for (const double more : found.more_inner) {
    out = joined(out, finite_regressor(*found.effect, signals, std::vector{more}));
  }
  return out;
}

MatrixXd full_rank(const MatrixXd& columns) {
  constexpr double kDependent = 1e-8;
  MatrixXd basis(columns.rows(), 0);
  std::vector<Index> kept;
  for (Index j = 0; j < columns.cols(); ++j) {
    const double length = columns.col(j).norm();
    if (!(length > 0.0)) continue;
    VectorXd left = columns.col(j) / length;
    for (int pass = 0; pass < 2; ++pass) left -= basis * (basis.transpose() * left).eval();
    if (left.norm() < kDependent) continue;
    basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
    basis.rightCols(1) = left.normalized();
    kept.push_back(j);
  }
  return columns(Eigen::all, kept);
}

SearchResult search(const SearchInput& input, const SearchOptions& options) {
  const Library library = make_library(input.signals, input.model);
  SearchResult result;
  result.not_testable = library.not_testable;
  std::uint64_t seed = options.seed;
  while (result.found.size() < options.most_effects) {
    // An effect that was found is still a candidate of the library; its own columns are in the base
    // and leave nothing of it to test.
    const MatrixXd base = base_with(input, result.found);
    if (base.rows() <= base.cols() + 2) break;
    result.bounds.clear();
    const Step step = forward_step(
        input, library, base,
        result.found.empty() ? options.false_alarm_rate : options.later_false_alarm_rate, seed,
        &result.bounds);
    seed += 2;
    result.p_of_step.push_back(step.p_value);
    if (!step.significant) break;
    const auto again = std::find_if(result.found.begin(), result.found.end(), [&](const Found& f) {
      return f.effect == step.found.effect;
    });
    if (again != result.found.end()) {
      if (step.found.inner.empty() || again->more_inner.size() >= kMostShapes) break;
      again->more_inner.push_back(step.found.inner.front());
      continue;
    }
    if (!step.outside_shape.empty() && result.outside_shape.empty()) {
      result.outside_shape = step.outside_shape;
      result.p_outside = step.p_outside;
    }
    result.found.push_back(step.found);
    refine_all(input, library, result.found);
    drop_superfluous(input, library, result.found, seed + 1000);
  }
  return result;
}

}  // namespace fogbench::model
