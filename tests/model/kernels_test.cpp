#include "model/fit/kernels.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;

/// Both builds of the loops, on sizes that fill vector registers and on some that do not.
class KernelsTest : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { std::srand(20261130U); }  // Eigen's Random
  const Index n_ = GetParam();
  const Kernels* const both_[2] = {&kernels(), &portable_kernels()};
};

TEST_P(KernelsTest, ScoresAreProductsOfColumns) {
  const MatrixXf a = MatrixXf::Random(n_, 5), b = MatrixXf::Random(n_, 3);
  const MatrixXd expected = a.cast<double>().transpose() * b.cast<double>();
  for (const Kernels* k : both_) {
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
  for (const Kernels* k : both_) {
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
  for (const Kernels* k : both_) {
    MatrixXd data = y;
    k->innovations({phi.data(), decay.data(), gain.data(), deviation.data(), kTerms}, kFirst,
                   kWindows, n_, data.data());
    EXPECT_LT((data - expected).cwiseAbs().maxCoeff(), 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, KernelsTest, testing::Values(1, 3, 8, 64, 77));

}  // namespace
}  // namespace fogbench::model
