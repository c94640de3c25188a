#include "model/noise/noise.hpp"

#include <algorithm>
#include <cmath>

#include "model/fit/kernels.hpp"
#include "model/noise/window_geometry.hpp"

namespace fogbench::model {
namespace {

constexpr Eigen::Index kColumnsAtATime = 64;

/// The innovations form. With the state s at a window's start, its prediction covariance P and the
/// window's mean y:
///   innovation v = y - phi's,  variance S,  next start: s <- decay * s + gain v
/// The gains depend on the noise and the windows, not on y, so any number of columns is filtered
/// at the cost of two products a row (fit/kernels.hpp).
class StateSpaceWhitener final : public Whitener {
 public:
  StateSpaceWhitener(std::shared_ptr<const WindowGeometry> geometry, const NoiseCoefficients& noise)
      : geometry_(std::move(geometry)) {
    const WindowGeometry& g = *geometry_;
    const double b2 = noise.bias_instability_deg_per_h * noise.bias_instability_deg_per_h;
    const double n2 =
        noise.angle_random_walk_deg_per_sqrt_h * noise.angle_random_walk_deg_per_sqrt_h;
    k2_ = noise.rate_random_walk_deg_per_h_per_sqrt_h * noise.rate_random_walk_deg_per_h_per_sqrt_h;
    flicker_variance_ = b2 * g.ladder.variance_per_b2;
    white_variance_ = n2 * g.white_per_n2;
    terms_ = g.phi.rows();
    gain_.resize(terms_ + 1, g.rows());
    deviation_.resize(g.rows());
    const Eigen::ArrayXd own =
        flicker_variance_ * g.mean_spread + k2_ * g.duration_h / 3.0 + white_variance_;
    const Eigen::ArrayXd walk_end = 0.5 * k2_ * g.duration_h, walk = k2_ * g.step_h;
    const Kernels::Noise noise_of_rows{.variance = flicker_variance_,
                                       .own = own.data(),
                                       .end_covariance = g.end_cov.data(),
                                       .walk_end = walk_end.data(),
                                       .walk = walk.data()};
    for_each_run([&](Eigen::Index first, Eigen::Index last) {
      kernels().gains(states(), noise_of_rows, first, last, gain_.data(), deviation_.data());
    });
  }

  Eigen::MatrixXd whiten(const Eigen::MatrixXd& columns) const override {
    // In blocks whose states stay in the fastest cache.
    Eigen::MatrixXd out(columns.rows(), columns.cols());
    for (Eigen::Index first = 0; first < columns.cols(); first += kColumnsAtATime) {
      const Eigen::Index count = std::min(kColumnsAtATime, columns.cols() - first);
      Eigen::MatrixXd block = columns.middleCols(first, count).transpose();
      whiten_transposed(block);
      out.middleCols(first, count) = block.transpose();
    }
    return out;
  }

  Eigen::MatrixXd colour(const Eigen::MatrixXd& columns) const override {
    Eigen::MatrixXd out = columns.transpose();
    for_each_run([&](Eigen::Index first, Eigen::Index last) {
      Eigen::MatrixXd state = Eigen::MatrixXd::Zero(columns.cols(), terms_ + 1);
      for (Eigen::Index i = first; i < last; ++i) {
        const Eigen::VectorXd innovation = out.col(i) * deviation_[i];
        out.col(i).noalias() = innovation + state * phi(i);
        state.leftCols(terms_) *= geometry_->decay.col(i).matrix().asDiagonal();
        state.noalias() += innovation * gain_.col(i).transpose();
      }
    });
    return out.transpose();
  }

  Eigen::MatrixXd colour_transposed(const Eigen::MatrixXd& columns) const override {
    // The adjoint of colour(): the same recursion read backwards.
    Eigen::MatrixXd out = columns.transpose();
    for_each_run([&](Eigen::Index first, Eigen::Index last) {
      Eigen::MatrixXd adjoint = Eigen::MatrixXd::Zero(columns.cols(), terms_ + 1);
      for (Eigen::Index i = last; i-- > first;) {
        const Eigen::VectorXd weight = out.col(i);
        out.col(i).noalias() += adjoint * gain_.col(i);
        out.col(i) *= deviation_[i];
        adjoint.leftCols(terms_) *= geometry_->decay.col(i).matrix().asDiagonal();
        adjoint.noalias() += weight * phi(i).transpose();
      }
    });
    return out.transpose();
  }

  double log_determinant() const override { return 2.0 * deviation_.array().log().sum(); }

  Eigen::VectorXd standard_deviation() const override {
    const WindowGeometry& g = *geometry_;
    return (white_variance_ + flicker_variance_ * g.mean_total +
            k2_ * (g.start_h + g.duration_h / 3.0))
        .sqrt();
  }

 private:
  Kernels::States states() const {
    return {.phi = geometry_->phi.data(), .decay = geometry_->decay.data(), .terms = terms_};
  }

  Eigen::VectorXd phi(Eigen::Index i) const {
    Eigen::VectorXd phi(terms_ + 1);
    phi << geometry_->phi.col(i).matrix(), 1.0;
    return phi;
  }

  /// One column of the data a row.
  void whiten_transposed(Eigen::MatrixXd& block) const {
    const Kernels::Filter filter{
        .states = states(), .gain = gain_.data(), .deviation = deviation_.data()};
    for_each_run([&](Eigen::Index first, Eigen::Index last) {
      kernels().innovations(filter, first, last, block.rows(), block.data());
    });
  }

  template <class Run>
  void for_each_run(const Run& run) const {
    for (std::size_t k = 0; k + 1 < geometry_->run_begin.size(); ++k) {
      run(static_cast<Eigen::Index>(geometry_->run_begin[k]),
          static_cast<Eigen::Index>(geometry_->run_begin[k + 1]));
    }
  }

  std::shared_ptr<const WindowGeometry> geometry_;
  double flicker_variance_ = 0.0;
  double k2_ = 0.0;
  Eigen::ArrayXd white_variance_;
  Eigen::Index terms_ = 0;
  Eigen::MatrixXd gain_;       // states x rows
  Eigen::VectorXd deviation_;  // of each innovation
};

class IndependentWhitener final : public Whitener {
 public:
  explicit IndependentWhitener(Eigen::VectorXd deviation) : deviation_(std::move(deviation)) {}

  Eigen::MatrixXd whiten(const Eigen::MatrixXd& columns) const override {
    return deviation_.cwiseInverse().asDiagonal() * columns;
  }
  Eigen::MatrixXd colour(const Eigen::MatrixXd& columns) const override {
    return deviation_.asDiagonal() * columns;
  }
  Eigen::MatrixXd colour_transposed(const Eigen::MatrixXd& columns) const override {
    return colour(columns);
  }
  double log_determinant() const override { return 2.0 * deviation_.array().log().sum(); }
  Eigen::VectorXd standard_deviation() const override { return deviation_; }

 private:
  Eigen::VectorXd deviation_;
};

Status check_coefficients(const NoiseCoefficients& noise) {
  const double all[] = {noise.angle_random_walk_deg_per_sqrt_h, noise.bias_instability_deg_per_h,
                        noise.rate_random_walk_deg_per_h_per_sqrt_h};
  double sum = 0.0;
  for (double coefficient : all) {
    if (!(coefficient >= 0.0) || !std::isfinite(coefficient)) {
      return Error{ErrorCode::kBadInput, "noise coefficients must be numbers of at least zero"};
    }
    sum += coefficient;
  }
  if (sum == 0.0) return Error{ErrorCode::kBadInput, "noise coefficients N, B and K are all zero"};
  return {};
}

}  // namespace

std::unique_ptr<Whitener> make_whitener(std::shared_ptr<const WindowGeometry> geometry,
                                        const NoiseCoefficients& noise) {
  return std::make_unique<StateSpaceWhitener>(std::move(geometry), noise);
}

Result<std::unique_ptr<Whitener>> make_whitener(const Windows& windows,
                                                const NoiseCoefficients& noise) {
  if (auto status = check_coefficients(noise); !status) return status.error();
  auto geometry = WindowGeometry::make(windows);
  if (!geometry) return geometry.error();
  return make_whitener(*geometry, noise);
}

std::unique_ptr<Whitener> make_independent_whitener(Eigen::VectorXd standard_deviation) {
  return std::make_unique<IndependentWhitener>(std::move(standard_deviation));
}

Result<Eigen::MatrixXd> noise_covariance(const Windows& windows, const NoiseCoefficients& noise) {
  if (auto status = check_coefficients(noise); !status) return status.error();
  auto made = WindowGeometry::make(windows);
  if (!made) return made.error();
  const WindowGeometry& g = **made;
  const double b2 = noise.bias_instability_deg_per_h * noise.bias_instability_deg_per_h;
  const double n2 = noise.angle_random_walk_deg_per_sqrt_h * noise.angle_random_walk_deg_per_sqrt_h;
  const double k2 =
      noise.rate_random_walk_deg_per_h_per_sqrt_h * noise.rate_random_walk_deg_per_h_per_sqrt_h;
  const double flicker = b2 * g.ladder.variance_per_b2;
  Eigen::MatrixXd omega = Eigen::MatrixXd::Zero(g.rows(), g.rows());
  for (std::size_t run = 0; run + 1 < g.run_begin.size(); ++run) {
    const auto first = static_cast<Eigen::Index>(g.run_begin[run]);
    const auto last = static_cast<Eigen::Index>(g.run_begin[run + 1]);
    for (Eigen::Index i = first; i < last; ++i) {
      omega(i, i) = n2 * g.white_per_n2[i] + flicker * g.mean_total[i] +
                    k2 * (g.start_h[i] + g.duration_h[i] / 3.0);
      const double centre_h = g.start_h[i] + 0.5 * g.duration_h[i];
      for (Eigen::Index j = i + 1; j < last; ++j) {
        const double gap_s = 3600.0 * (g.start_h[j] - g.start_h[i] - g.duration_h[i]);
        double sum = k2 * centre_h;
        for (std::size_t t = 0; t < g.ladder.tau_s.size(); ++t) {
          const auto row = static_cast<Eigen::Index>(t);
          sum += flicker * std::exp(-gap_s / g.ladder.tau_s[t]) * g.phi(row, i) * g.phi(row, j);
        }
        omega(i, j) = omega(j, i) = sum;
      }
    }
  }
  return omega;
}

}  // namespace fogbench::model
