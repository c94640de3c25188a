#include "model/compare/difference.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

namespace fogbench::model {
namespace {

using testing::ElementsAre;

/// A fit with these values; `covariance` of all of them.
FitResult fit_of(const std::vector<std::pair<std::string, double>>& values,
                 const Eigen::MatrixXd& covariance) {
  FitResult out;
  for (const auto& [name, value] : values) {
    const auto k = static_cast<Eigen::Index>(out.estimates.size());
    out.estimates.push_back({name, "deg/h", value, std::sqrt(covariance(k, k))});
  }
  out.covariance = covariance;
  return out;
}

Eigen::MatrixXd correlated(double sigma_a, double sigma_b, double correlation) {
  Eigen::MatrixXd out(2, 2);
  out << sigma_a * sigma_a, correlation * sigma_a * sigma_b, correlation * sigma_a * sigma_b,
      sigma_b * sigma_b;
  return out;
}

TEST(Difference, HasTheUncertaintiesOfBoth) {
  const Eigen::MatrixXd covariance = correlated(0.03, 0.004, 0.0);
  const Difference d = difference_between(fit_of({{"bias", 1.0}, {"slope", 0.5}}, covariance),
                                          fit_of({{"bias", 1.1}, {"slope", 0.4}}, covariance));
  ASSERT_EQ(d.coefficients.size(), 2U);
  EXPECT_NEAR(d.coefficients[0].difference, 0.1, 1e-12);
  EXPECT_NEAR(d.coefficients[0].expanded_uncertainty, 2.0 * std::sqrt(2.0) * 0.03, 1e-12);
  // 0.1 is 2.36 sigma: 0.0184 for one, 0.0365 for the larger of two.
  EXPECT_NEAR(d.coefficients[0].p_of_all, 0.0365, 0.0003);
  EXPECT_LT(d.coefficients[1].p_of_all, 1e-9);
  EXPECT_TRUE(d.differs());
}

TEST(Difference, OfCorrelatedCoefficientsIsJudgedTogether) {
  // Each within its uncertainty, but against their correlation.
  const Eigen::MatrixXd covariance = correlated(1.0, 1.0, 0.99);
  const Difference d = difference_between(fit_of({{"a", 0.0}, {"b", 0.0}}, covariance),
                                          fit_of({{"a", 1.0}, {"b", -1.0}}, covariance));
  EXPECT_FALSE(d.coefficients[0].differs());
  EXPECT_FALSE(d.coefficients[1].differs());
  EXPECT_LT(d.p_same, 1e-9);
}

TEST(Difference, LeavesOutWhatOneDoesNotDetermine) {
  FitResult a = fit_of({{"bias", 1.0}, {"slope", 0.5}}, correlated(0.1, 0.1, 0.0));
  a.estimates[1].value = a.estimates[1].standard_error = kMissing;
  FitResult b = fit_of({{"bias", 1.0}, {"slope", 0.5}}, correlated(0.1, 0.1, 0.0));
  const Difference d = difference_between(a, b);
  ASSERT_EQ(d.coefficients.size(), 1U);
  EXPECT_THAT(d.not_in_both, ElementsAre("slope"));
  EXPECT_NEAR(d.p_same, 1.0, 1e-12);
  b.estimates[0].held = a.estimates[0].held = true;
  EXPECT_TRUE(std::isnan(difference_between(a, b).p_same));
}

// In 4000 repeats of one truth the stated chances come as often as they say.
TEST(Difference, ChancesAreThoseOfNoise) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd covariance = correlated(0.2, 0.3, 0.6);
  const Eigen::MatrixXd root = covariance.llt().matrixL();
  const auto measured = [&] {
    const Eigen::VectorXd noise =
        root * Eigen::VectorXd::NullaryExpr(2, [&] { return normal(random); });
    return fit_of({{"a", 1.0 + noise[0]}, {"b", -2.0 + noise[1]}}, covariance);
  };
  constexpr int kRepeats = 4000;
  int together = 0, any = 0;
  for (int i = 0; i < kRepeats; ++i) {
    const Difference d = difference_between(measured(), measured());
    together += d.differs() ? 1 : 0;
    any += d.coefficients[0].differs() || d.coefficients[1].differs() ? 1 : 0;
  }
  // 5 % of 4000 is 200 +- 14; of two correlated ones at most as many.
  EXPECT_NEAR(together, 200, 45);
  EXPECT_LT(any, 245);
  EXPECT_GT(any, 120);
}

}  // namespace
}  // namespace fogbench::model
