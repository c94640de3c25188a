#include "simulator/random.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fogbench::simulator {
namespace {

TEST(RandomEngine, GivesThePublishedNumbers) {
  // SplitMix64 and xoshiro256++ seeded by it, from seed 0: the reference values of the Rust crate
  // rand_xoshiro 0.6, which are those of the authors' C code.
  EXPECT_EQ(mix_bits(0), 0xE220A8397B1DCDAFU);
  RandomEngine engine(0);
  EXPECT_EQ(engine(), 0x53175D61490B23DFU);
  EXPECT_EQ(engine(), 0x61DA6F3DC380D507U);
  EXPECT_EQ(engine(), 0x5C0FDF91EC9A7BFCU);
}

TEST(DeriveSeed, DependsOnSeedAndName) {
  EXPECT_EQ(derive_seed(1, "gyro"), derive_seed(1, "gyro"));
  EXPECT_NE(derive_seed(1, "gyro"), derive_seed(2, "gyro"));
  EXPECT_NE(derive_seed(1, "gyro"), derive_seed(1, "gyrp"));
  EXPECT_NE(derive_seed(1, "ab"), derive_seed(1, "ba"));
  EXPECT_NE(derive_seed(1, std::uint64_t{5}), derive_seed(1, std::uint64_t{6}));
}

TEST(NormalSource, HasTheMomentsOfAStandardNormal) {
  NormalSource normal(12);
  constexpr int kCount = 1000000;
  double sum = 0.0;
  double squares = 0.0;
  double fourth = 0.0;
  int beyond_three = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = normal();
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
    beyond_three += std::abs(x) > 3.0 ? 1 : 0;
  }
  // Five standard errors: 1, sqrt(2), sqrt(96) over sqrt(count), and a binomial's.
  EXPECT_NEAR(sum / kCount, 0.0, 5e-3);
  EXPECT_NEAR(squares / kCount, 1.0, 7.1e-3);
  EXPECT_NEAR(fourth / kCount, 3.0, 4.9e-2);
  EXPECT_NEAR(beyond_three, 2699.8, 5.0 * 51.9);
}

TEST(NormalSource, UniformStaysInsideItsInterval) {
  NormalSource source(3);
  double sum = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const double u = source.uniform();
    ASSERT_GT(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
  }
  EXPECT_NEAR(sum / 100000, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / 100000));
}

}  // namespace
}  // namespace fogbench::simulator
