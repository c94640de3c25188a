#pragma once
// At which noise shapes a posterior is summed. The grid of NoiseShapes is coarse: a factor of two
// or three from one shape to the next. Hundreds of rows tell a random walk to a tenth of its size,
// and a sum over shapes of which none is right takes the walk for an effect. So the steps are
// halved where a posterior is narrower than they are, around the shapes that carry it.

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "model/noise/noise_shapes.hpp"

namespace fogbench::model {

class ShapeGrid {
 public:
  /// The grid of `shapes`, which must outlive it.
  explicit ShapeGrid(const NoiseShapes& shapes);

  /// Shapes so far; new ones come behind the others.
  std::size_t size() const { return nodes_.size(); }
  /// With N = 1 deg/sqrt(h). Shape 0 is white.
  const NoiseCoefficients& shape(std::size_t i) const { return nodes_[i].shape; }
  std::shared_ptr<const Whitener> whitener(std::size_t i) const;
  /// Of the shape's cell at the present steps.
  double log_prior(std::size_t i) const { return log_prior(nodes_[i].shape); }
  /// Of any shape, per cell: comparable with those of the grid.
  double log_prior(const NoiseCoefficients& shape) const;
  /// Present steps of the natural logarithms of B/N and K/N.
  double step_of_b() const { return step(shapes_.b_over_n(), halvings_.first); }
  double step_of_k() const { return step(shapes_.k_over_n(), halvings_.second); }

  /// Adds shapes where one of the posteriors is not resolved: each is a log likelihood, one value a
  /// shape so far. False: all are, and nothing was added.
  bool refine(const std::vector<std::vector<double>>& log_likelihoods);

 private:
  /// Where a shape lies: in units of the finest steps above the axis' least value, -1 for zero.
  using Place = std::pair<int, int>;
  struct Node {
    NoiseCoefficients shape;
    Place place;
  };
  static double step(const RatioAxis& axis, int halvings);
  bool within(Place place) const;
  bool add(Place place);
  /// The places next to this one at the present steps, by B or by K.
  std::vector<Place> beside(Place place, bool by_b) const;

  const NoiseShapes& shapes_;
  std::vector<Node> nodes_;
  std::map<Place, std::size_t> index_;
  std::pair<int, int> halvings_{0, 0};  ///< of the steps of B/N and of K/N
};

}  // namespace fogbench::model
