#include "model/diagnose/stage.hpp"

#include <algorithm>
#include <cmath>

namespace fogbench::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Of noise alone: so many first, and all of them while the p-value of what leads is near a level
// that decides something.
constexpr Index kFirstDraws = 199;
constexpr Index kAllDraws = 499;
constexpr double kClearlySo = 2e-4;
constexpr double kClearlyNot = 0.15;
constexpr Index kRivalDraws = 299;
constexpr int kInstants = 16;
// A coefficient stands beyond this many standard errors.
constexpr double kStands = 2.0;
// How far a memory's beginning may lie beyond what the effect's coefficient makes of its input's
// range: before the first row the input may have been somewhat outside.
constexpr double kBeyondRangeOfInput = 1.5;
// Twice the log-likelihood that one parameter gains by chance in less than 5 %.
constexpr double kPushes = 3.84;

}  // namespace

Stage::Stage(const SearchInput& input, MatrixXd base, std::uint64_t seed)
    : input_(input),
      base_(std::move(base)),
      seed_(seed),
      detector_(input.whitened, base_, input.y),
      calibration_(detector_.lambdas(detector_.draw(kFirstDraws, seed))),
      lead_(calibration_.lead(detector_.observed())) {
  for (Index c = 0; c < detector_.candidates(); ++c) {
    if (!detector_.testable(c)) continue;
    (candidate(c).shadow() ? shadows_ : effects_).push_back(c);
  }
  if (!is_open(effects_) && !is_open(shadows_)) return;
  calibration_.add(detector_.lambdas(detector_.draw(kAllDraws - kFirstDraws, ~seed)));
  lead_ = calibration_.lead(detector_.observed());
}

bool Stage::is_open(const std::vector<Index>& among) const {
  if (among.empty()) return false;
  const double p = p_value(best(among));
  return p > kClearlySo && p < kClearlyNot;
}

Index Stage::best(const std::vector<Index>& among) const {
  return *std::max_element(among.begin(), among.end(),
                           [&](Index a, Index b) { return lead_[a] < lead_[b]; });
}

bool Stage::stands(Index c) const {
  const auto coefficient = detector_.coefficients(c);
  const Index own = candidate(c).own;
  const auto value = coefficient.value.array().abs();
  const auto error = kStands * coefficient.standard_error.array();
  if (!(value.head(own) > error.head(own)).any()) return false;
  const Index starts = value.size() - own;
  const double most = kBeyondRangeOfInput * value.head(own).maxCoeff();
  return (value.tail(starts) - error.tail(starts) <= most).all();
}

Index Stage::leader(const std::vector<std::size_t>& refused) const {
  std::vector<Index> allowed, standing;
  for (const Index c : effects_) {
    if (std::find(refused.begin(), refused.end(), static_cast<std::size_t>(c)) != refused.end())
      continue;
    allowed.push_back(c);
    if (lead_[c] > 0.0 && stands(c)) standing.push_back(c);
  }
  const Index first = best(standing.empty() ? allowed : standing);
  const bool edge = at_edge(first);
  std::vector<Index> simpler;
  for (const Index c : standing) {
    const bool its_limit =
        edge ? !candidate(c).parameter : candidate(c).name == candidate(first).extends;
    if (its_limit && lead_[first] - lead_[c] < kNearlyAsWell) simpler.push_back(c);
  }
  return simpler.empty() ? first : best(simpler);
}

double Stage::plausible(Index world, double lag, const std::vector<Index>& others) {
  const auto among = &others == &effects_ ? Detector::Among::kEffects : Detector::Among::kAll;
  const Noise& noise = noise_of(world, among);
  const MatrixXd leads = calibration_.lead(detector_.lambdas(
      noise.draws, detector_.fitted_signal(world) / larger_noise(world, noise), among));
  Index reached = 0;
  for (Index b = 0; b < leads.cols(); ++b) {
    double top = leads(world, b);
    for (const Index c : others) top = std::max(top, leads(c, b));
    reached += top - leads(world, b) >= lag ? 1 : 0;
  }
  return static_cast<double>(reached) / static_cast<double>(leads.cols());
}

const Stage::Noise& Stage::noise_of(Index world, Detector::Among among) {
  const auto [known, is_new] = noise_.try_emplace(detector_.best_view(world));
  Noise& noise = known->second;
  if (is_new) {
    noise = {world, detector_.draw(kRivalDraws, seed_ + 1, world, among)};
  } else {
    detector_.score(noise.draws, among);
  }
  return noise;
}

double Stage::larger_noise(Index world, const Noise& noise) const {
  const double free = static_cast<double>(base_.rows() - base_.cols());
  const double own =
      static_cast<double>(detector_.best_block(world).width) + (candidate(world).parameter ? 1 : 0);
  const VectorXd& lambda = detector_.observed();
  const double behind = lambda[noise.beside] - lambda[world];
  return std::sqrt(std::exp(behind / free) * free / std::max(free - own, 1.0));
}

bool Stage::at_edge(Index c) const {
  const Candidate& which = candidate(c);
  if (!which.parameter || which.instant()) return false;
  const double inner = detector_.best_block(c).inner;  // the grid is the same for every shape
  return inner == which.blocks.front().inner || inner == which.blocks.back().inner;
}

bool Stage::beyond_range(Index c) const {
  if (!at_edge(c)) return false;
  const Candidate& which = candidate(c);
  const Block& end = detector_.best_block(c);
  double within = -1.0;
  for (const Block& block : which.blocks) {
    const bool is_end =
        block.inner == which.blocks.front().inner || block.inner == which.blocks.back().inner;
    if (is_end || block.shape != end.shape) continue;
    within = std::max(within, detector_.lambda_of(which.shapes[block.shape](block.inner)));
  }
  return detector_.lambda_of(which.shapes[end.shape](end.inner)) - within > kPushes;
}

double Stage::refined(Index c) const {
  const Candidate& which = candidate(c);
  const double inner = detector_.best_block(c).inner;
  if (!which.parameter) return inner;
  const Block& top = detector_.best_block(c);
  const auto neighbour = [&](std::ptrdiff_t step) {
    const std::ptrdiff_t at = &top - which.blocks.data() + step;
    if (at < 0 || at >= std::ssize(which.blocks)) return inner;
    const Block& next = which.blocks[static_cast<std::size_t>(at)];
    return next.shape == top.shape ? next.inner : inner;
  };
  double low = neighbour(-1), high = neighbour(+1);
  if (which.instant()) {
    // A staircase with slopes inside the windows: no place for a golden section.
    double best = inner, most = -1.0;
    for (int i = 0; i <= kInstants; ++i) {
      const double trial = low + (high - low) * i / kInstants;
      const double value = detector_.lambda_of(which.shapes[top.shape](trial));
      if (value > most) {
        most = value;
        best = trial;
      }
    }
    return best;
  }
  constexpr double kGolden = 0.381966;
  constexpr int kRounds = 12;
  const auto lambda = [&](double value) {
    return detector_.lambda_of(which.shapes[top.shape](value));
  };
  double inside = inner, best = lambda(inside);
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
  return inside;
}

std::vector<Bound> Stage::bounds() const {
  constexpr double kTwoSided95 = 1.96;
  std::vector<Bound> out;
  for (const Index c : effects_) {
    const auto coefficient = detector_.coefficients(c);
    const Index own = candidate(c).own;
    const VectorXd most =
        coefficient.value.head(own).cwiseAbs() + kTwoSided95 * coefficient.standard_error.head(own);
    out.push_back({candidate(c).name, most.maxCoeff(),
                   candidate(c).units.empty() ? "" : candidate(c).units.front()});
  }
  return out;
}

}  // namespace fogbench::model
