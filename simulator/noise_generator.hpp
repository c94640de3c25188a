#pragma once
// Gyro rate noise, drawn exactly at any sample time T. With T in hours,
//
//   y_k = N n_k / sqrt(T)                     white: angle random walk
//       + sum_j mean of x_j over the bin      flicker: Ornstein-Uhlenbeck processes
//       + mean of w over the bin              rate random walk, dw = K dW
//
// The correlation times of the x_j lie a ratio r = 4 apart, from T/40 to at least 1e5 s; each has
// the variance B^2 ln(r)/pi and starts from its stationary law. Their sum has the Allan deviation
// 0.664 B, flat between T and 1e5 s; the shorter times that are left out would add 1.7 % to the
// Allan variance at T.
//
// The whole is a linear Gaussian process with the state x = (x_1 ... x_J, w), so that a block of M
// bin means and the state at the block's end, z = (y_1 ... y_M, x_end), given the state at its
// start, is exactly
//
//   z = G x_start + L n,   L L' = cov(z | x_start),   n of M + J + 1 standard normals.
//
// G and L follow once from the joint law of (end state, bin mean) of one step; a block then costs
// two small matrix-vector products instead of 2 J + 3 normals a sample.
//
// Quantisation is not noise added to a rate: AngleQuantiser takes the difference of quantised
// angles.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "config/scenario.hpp"
#include "simulator/random.hpp"

namespace fogbench::simulator {

/// One component of the noise over a bin of length T, given its state x at the bin's start:
///   end = decay x + e,   mean = mean_gain x + u,   (e, u) jointly normal.
struct BinProcess {
  double decay = 1.0;
  double mean_gain = 1.0;
  double end_variance = 0.0;
  double end_mean_covariance = 0.0;
  double mean_variance = 0.0;
  double start_variance = 0.0;  ///< of x when the generator starts
};

/// Ornstein-Uhlenbeck process with stationary `variance` and correlation time `tau`; `bin` in the
/// same unit of time.
BinProcess ornstein_uhlenbeck(double variance, double tau, double bin);

class NoiseGenerator {
 public:
  static constexpr std::size_t kBlock = 32;
  static constexpr double kRatio = 4.0;
  static constexpr double kShortestTau = 1.0 / 40.0;  ///< in sample times
  static constexpr double kLongestTauS = 1e5;

  NoiseGenerator(const config::NoiseCoefficients& noise, double interval_s, std::uint64_t seed);

  /// Mean of the noise rate over the next bin, deg/h.
  double next() {
    if (position_ == kBlock) draw_block();
    return block_[position_++];
  }

  /// The components besides white noise, for checks against theory.
  const std::vector<BinProcess>& processes() const { return processes_; }

 private:
  void draw_block();

  NormalSource normal_;
  std::vector<BinProcess> processes_;
  std::vector<double> gain_;   ///< [G L], column-major, kBlock + J rows
  std::vector<double> input_;  ///< state at the block's start, then the normals
  std::vector<double> block_;  ///< kBlock bin means, then the state at the block's end
  std::size_t position_ = kBlock;
};

/// The output of a gyro that counts whole angle increments: rate = difference of the quantised
/// angle / T. The error is anti-correlated from sample to sample, with Allan variance 3 Q^2/tau^2
/// for an increment of sqrt(12) Q.
class AngleQuantiser {
 public:
  AngleQuantiser(double quantisation_deg, double interval_s);
  /// Unchanged when Q is 0.
  double quantise(double rate_deg_per_h);

 private:
  double increment_deg_;
  double interval_h_;
  double angle_ = 0.0;  ///< in increments, what the last count left over
};

}  // namespace fogbench::simulator
