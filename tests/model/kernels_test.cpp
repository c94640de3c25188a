#include "model/fit/kernels.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;

/// Every build of the loops that this machine can run, on sizes that fill vector registers and on
/// some that do not.
class KernelsTest : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { std::srand(20261130U); }  // Eigen's Random
  const Index n_ = GetParam();
  const std::vector<const Kernels*> all_ = all_kernels();
};

TEST_P(KernelsTest, ScoresAreProductsOfColumns) {
  const MatrixXf a = MatrixXf::Random(n_, 5), b = MatrixXf::Random(n_, 3);
  const MatrixXd expected = a.cast<double>().transpose() * b.cast<double>();
  for (const Kernels* k : all_) {
    MatrixXf out(5, 3);
    k->scores(a.data(), b.data(), n_, 5, 3, out.data());
    EXPECT_LT((out.cast<double>() - expected).cwiseAbs().maxCoeff(), 1e-5 * std::sqrt(n_));
  }
}

TEST_P(KernelsTest, ProjectionLeavesNothingAlongTheBasis) {
  const Index r = std::min<Index>(n_, 2);
  const MatrixXd q = Eigen::HouseholderQR<MatrixXd>(MatrixXd::Random(n_, r)).householderQ() *
                     MatrixXd::Identity(n_, r);
  const MatrixXd given = MatrixXd::Random(n_, 7);
  for (const Kernels* k : all_) {
    MatrixXd z = given;
    k->project(q.data(), n_, r, z.data(), 7);
    EXPECT_LT((q.transpose() * z).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_LT((z + q * (q.transpose() * given) - given).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST_P(KernelsTest, InnovationsObeyTheFiltersEquations) {
  constexpr Index kWindows = 6, kFirst = 2, kTerms = 3;
  const MatrixXd phi = MatrixXd::Random(kTerms, kWindows),
                 decay = MatrixXd::Random(kTerms, kWindows);
  const MatrixXd gain = MatrixXd::Random(kTerms + 1, kWindows);
  const VectorXd deviation = VectorXd::Random(kWindows).array() + 2.0;
  const MatrixXd y = MatrixXd::Random(n_, kWindows);
  MatrixXd expected = y;
  MatrixXd s = MatrixXd::Zero(kTerms + 1, n_);
  for (Index i = kFirst; i < kWindows; ++i) {
    VectorXd full_phi(kTerms + 1), full_decay(kTerms + 1);
    full_phi << phi.col(i), 1.0;
    full_decay << decay.col(i), 1.0;
    const VectorXd v = y.col(i) - s.transpose() * full_phi;
    s = full_decay.asDiagonal() * s + gain.col(i) * v.transpose();
    expected.col(i) = v / deviation[i];
  }
  for (const Kernels* k : all_) {
    MatrixXd data = y;
    k->innovations({{phi.data(), decay.data(), kTerms}, gain.data(), deviation.data()}, kFirst,
                   kWindows, n_, data.data());
    EXPECT_LT((data - expected).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST_P(KernelsTest, GainsFollowTheStatesCovariance) {
  const Index windows = n_;
  constexpr Index kTerms = 6;
  const auto between = [&](double least, double most, Index rows) -> MatrixXd {
    return ((MatrixXd::Random(rows, windows).array() + 1.0) / 2.0 * (most - least) + least);
  };
  const MatrixXd phi = between(0.5, 1.0, kTerms), decay = between(0.1, 0.9, kTerms),
                 end = between(0.0, 0.2, kTerms), own = between(0.5, 2.0, 1),
                 walk_end = between(0.0, 0.1, 1), walk = between(0.1, 0.2, 1);
  constexpr double kVariance = 0.7;
  MatrixXd gain(kTerms + 1, windows), p = MatrixXd::Zero(kTerms + 1, kTerms + 1);
  VectorXd deviation(windows);
  p.diagonal().head(kTerms).setConstant(kVariance);
  for (Index i = 0; i < windows; ++i) {
    VectorXd f(kTerms + 1), d(kTerms + 1), c(kTerms + 1), fresh(kTerms + 1);
    f << phi.col(i), 1.0;
    d << decay.col(i), 1.0;
    c << kVariance * end.col(i), walk_end(0, i);
    fresh << (kVariance * (1.0 - decay.col(i).array().square())).matrix(), walk(0, i);
    const double s = f.dot(p * f) + own(0, i);
    c += d.asDiagonal() * p * f;
    gain.col(i) = c / s;
    deviation[i] = std::sqrt(s);
    p = (d.asDiagonal() * p * d.asDiagonal()).eval() - c * c.transpose() / s;
    p.diagonal() += fresh;
  }
  for (const Kernels* k : all_) {
    MatrixXd its_gain = gain * 0.0;
    VectorXd its_deviation = deviation * 0.0;
    k->gains({phi.data(), decay.data(), kTerms},
             {kVariance, own.data(), end.data(), walk_end.data(), walk.data()}, 0, windows,
             its_gain.data(), its_deviation.data());
    EXPECT_LT((its_gain - gain).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((its_deviation - deviation).cwiseAbs().maxCoeff(), 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, KernelsTest, testing::Values(1, 3, 8, 64, 77));

}  // namespace
}  // namespace fogbench::model
