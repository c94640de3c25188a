#pragma once
// A library's columns whitened under each noise shape. They are the same for every base, so they
// are kept from one step of a search to the next, as far as a bounded memory goes.

#include <Eigen/Core>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "model/diagnose/library.hpp"
#include "model/noise/noise_shapes.hpp"

namespace fogbench::model {

/// May be shared between threads.
class WhitenedLibrary {
 public:
  /// Both must outlive it.
  WhitenedLibrary(const NoiseShapes& shapes, const Library& library);

  const NoiseShapes& shapes() const { return shapes_; }
  const Library& tried() const { return library_; }
  /// `whitener`: of this shape.
  std::shared_ptr<const Eigen::MatrixXd> under(const NoiseCoefficients& shape,
                                               const Whitener& whitener) const;

  /// A few points of each candidate's grid: enough to see which noise shapes matter.
  const std::vector<Block>& sample() const { return sample_; }
  /// Their columns, as they are.
  const Eigen::MatrixXd& sampled() const { return sampled_; }

 private:
  const NoiseShapes& shapes_;
  const Library& library_;
  std::vector<Block> sample_;  // `first` in the sample
  Eigen::MatrixXd sampled_;
  mutable std::mutex mutex_;
  /// By B/N and K/N.
  mutable std::map<std::pair<double, double>, std::shared_ptr<const Eigen::MatrixXd>> kept_;
  mutable std::size_t bytes_ = 0;
};

}  // namespace fogbench::model
