#pragma once
// What the two halves of Detector share: one noise shape's view of the data and of the library.

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <thread>
#include <vector>

#include "model/diagnose/detector.hpp"
#include "model/fit/kernels.hpp"

namespace fogbench::model {

inline constexpr double kLeastSquares = 1e-24;  // deg^2/h: keeps a perfect fit finite

/// Two workers share the items; results do not depend on who does which.
template <class Work>
void in_parallel(std::size_t items, Work work) {
  std::atomic<std::size_t> next{0};
  const auto worker = [&] {
    for (std::size_t i = next++; i < items; i = next++) work(i);
  };
  std::thread other;
  if (items > 1 && std::thread::hardware_concurrency() > 1) other = std::thread(worker);
  worker();
  if (other.joinable()) other.join();
}

inline double log_sum_exp(const std::vector<double>& values) {
  const double top = *std::max_element(values.begin(), values.end());
  double sum = 0.0;
  for (const double v : values) sum += v - top > -40.0 ? std::exp(v - top) : 0.0;
  return top + std::log(sum);
}

struct Detector::View {
  std::shared_ptr<const Whitener> whitener;
  Eigen::MatrixXd q;        // basis of the whitened base
  Eigen::MatrixXf u;        // candidates' columns: whitened, projected, orthonormal within a block
  std::vector<bool> alive;  // per block, in the library's order
  Eigen::VectorXd residual;
  double squares = 0.0;
  double log_prior = 0.0;

  Eigen::MatrixXd project(Eigen::MatrixXd whitened) const {
    kernels().project(q.data(), q.rows(), q.cols(), whitened.data(), whitened.cols());
    return whitened;
  }
};

}  // namespace fogbench::model
