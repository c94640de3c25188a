#include "model/noise/shape_grid.hpp"

#include <algorithm>
#include <cmath>

namespace fogbench::model {
namespace {

// The finest steps: a factor of 1.07 where the grid's is 2.9.
constexpr int kMostHalvings = 4;
constexpr int kFinest = 1 << kMostHalvings;
// Down to steps of 2.4 standard deviations a sum over a normal posterior is right to a few per
// cent. There, the log weight falls by this much from its top to the next shape.
constexpr double kResolved = 3.0;
// exp(-4) of the best: shapes around which nothing is worth a closer look.
constexpr double kReach = 4.0;

double value_at(const RatioAxis& axis, int place) {
  return place < 0 ? 0.0 : axis.least * std::exp(axis.step * place / kFinest);
}

}  // namespace

ShapeGrid::ShapeGrid(const NoiseShapes& shapes) : shapes_(shapes) {
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto columns = shapes.k_over_n().count + 1;
    const auto at = static_cast<int>(i);
    const auto place_of = [](int line) { return line == 0 ? -1 : (line - 1) * kFinest; };
    const Place place{place_of(at / columns), place_of(at % columns)};
    index_[place] = i;
    nodes_.push_back({shapes.shape(i), place});
  }
}

std::shared_ptr<const Whitener> ShapeGrid::whitener(std::size_t i) const {
  return i < shapes_.size() ? shapes_.whitener(i) : shapes_.whitener(shape(i));
}

double ShapeGrid::step(const RatioAxis& axis, int halvings) {
  return std::ldexp(axis.step, -halvings);
}

double ShapeGrid::log_prior(const NoiseCoefficients& shape) const {
  const auto of = [](const RatioAxis& axis, const NoisePrior::Ratio& ratio, double value,
                     double its_step) {
    return value == 0.0 ? axis.log_prior_of_zero : ratio.log_density(value) + std::log(its_step);
  };
  const NoisePrior& prior = shapes_.prior();
  return of(shapes_.b_over_n(), prior.b_over_n, shape.bias_instability_deg_per_h, step_of_b()) +
         of(shapes_.k_over_n(), prior.k_over_n, shape.rate_random_walk_deg_per_h_per_sqrt_h,
            step_of_k());
}

bool ShapeGrid::within(Place place) const {
  return place.first <= (shapes_.b_over_n().count - 1) * kFinest &&
         place.second <= (shapes_.k_over_n().count - 1) * kFinest;
}

bool ShapeGrid::add(Place place) {
  if (!within(place) || index_.contains(place)) return false;
  index_[place] = nodes_.size();
  nodes_.push_back(
      {{.angle_random_walk_deg_per_sqrt_h = 1.0,
        .bias_instability_deg_per_h = value_at(shapes_.b_over_n(), place.first),
        .rate_random_walk_deg_per_h_per_sqrt_h = value_at(shapes_.k_over_n(), place.second)},
       place});
  return true;
}

std::vector<ShapeGrid::Place> ShapeGrid::beside(Place place, bool by_b) const {
  const int stride = kFinest >> (by_b ? halvings_.first : halvings_.second);
  const int at = by_b ? place.first : place.second;
  std::vector<int> others;
  if (at >= 0) others.push_back(std::max(at - stride, -1));
  others.push_back(at < 0 ? 0 : at + stride);
  std::vector<Place> out;
  for (const int other : others) {
    const Place next = by_b ? Place{other, place.second} : Place{place.first, other};
    if (within(next)) out.push_back(next);
  }
  return out;
}

bool ShapeGrid::refine(const std::vector<std::vector<double>>& log_likelihoods) {
  std::vector<std::size_t> carrying;
  bool narrow_b = false, narrow_k = false;
  const std::size_t before = size();
  for (const std::vector<double>& likelihood : log_likelihoods) {
    std::vector<double> weight = likelihood;
    for (std::size_t i = 0; i < before; ++i) weight[i] += log_prior(i);
    const auto best =
        static_cast<std::size_t>(std::max_element(weight.begin(), weight.end()) - weight.begin());
    for (std::size_t i = 0; i < before; ++i) {
      if (weight[i] > weight[best] - kReach) carrying.push_back(i);
    }
    for (const bool by_b : {true, false}) {
      double fall = 0.0, count = 0.0;
      for (const Place& next : beside(nodes_[best].place, by_b)) {
        if (add(next)) continue;
        const auto known = index_.at(next);
        if (known >= before) continue;
        fall += weight[best] - weight[known];
        count += 1.0;
      }
      if (count > 0.0) (by_b ? narrow_b : narrow_k) |= fall > kResolved * count;
    }
  }
  if (size() > before) return true;  // what is beside the best comes first
  narrow_b = narrow_b && halvings_.first < kMostHalvings;
  narrow_k = narrow_k && halvings_.second < kMostHalvings;
  halvings_.first += narrow_b ? 1 : 0;
  halvings_.second += narrow_k ? 1 : 0;
  for (const std::size_t i : carrying) {
    std::vector<Place> around{nodes_[i].place};
    if (narrow_b) {
      for (const Place& next : beside(nodes_[i].place, true)) around.push_back(next);
    }
    for (const Place& middle : around) {
      add(middle);
      if (!narrow_k) continue;
      for (const Place& next : beside(middle, false)) add(next);
    }
  }
  return size() > before;
}

}  // namespace fogbench::model
