#pragma once
// Two measurements against each other, coefficient by coefficient: two runs of one gyro, two tests
// of one run, or two gyros.
//
//   d_k = b_k - a_k,   U(d_k) = hypot(U(a_k), U(b_k))
//   p_k = P(|normal| > 2 |d_k| / U(d_k)), and of all n: 1 - (1 - p_k)^n
//   together: d' (Ca + Cb)^-1 d is chi2 of n

#include <string>
#include <vector>

#include "model/fit/fit.hpp"

namespace fogbench::model {

/// At this chance of looking so by noise alone, a difference is said to be one.
inline constexpr double kDiffers = 0.05;

struct CoefficientDifference {
  std::string name, unit;
  double a = kMissing, expanded_a = kMissing, b = kMissing, expanded_b = kMissing;
  double difference = kMissing, expanded_uncertainty = kMissing;  ///< b - a; 95.45 %
  double p_of_all = kMissing;  ///< that noise lets any of the coefficients differ so much
  bool differs() const { return p_of_all < kDiffers; }
};

struct Difference {
  std::vector<CoefficientDifference> coefficients;  ///< determined in both, in the model's order
  double p_same = kMissing;  ///< that both measured the same coefficients; NaN: nothing to compare
  /// Coefficients that one of the two does not determine, or neither.
  std::vector<std::string> not_in_both;
  bool differs() const { return p_same < kDiffers; }
};

/// Precondition: both are fits of one model.
Difference difference_between(const FitResult& a, const FitResult& b);

}  // namespace fogbench::model
