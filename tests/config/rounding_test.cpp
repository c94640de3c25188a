#include "config/rounding.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace fogbench::config {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string both(double value, double uncertainty) {
  const Rounded r = rounded(value, uncertainty);
  return r.value + " +- " + r.uncertainty;
}

TEST(Rounding, GivesTwoDigitsOfTheUncertaintyAndTheValueToTheSamePlace) {
  EXPECT_EQ(both(-0.0325935, 0.013), "-0.033 +- 0.013");
  EXPECT_EQ(both(-0.25318, 0.00096), "-0.25318 +- 0.00096");
  EXPECT_EQ(both(1.5, 0.13), "1.50 +- 0.13");
  EXPECT_EQ(both(0.00364289, 0.00055892), "0.00364 +- 0.00056");
}

TEST(Rounding, CountsTheDigitsAfterRoundingTheUncertainty) {
  EXPECT_EQ(both(1.0, 0.0996), "1.00 +- 0.10");
  EXPECT_EQ(both(1.0, 9.96), "1 +- 10");
}

TEST(Rounding, RoundsLargeNumbersToo) {
  EXPECT_EQ(both(1402.0, 3575.0), "1400 +- 3600");
  EXPECT_EQ(both(1234.5, 20.0), "1234 +- 20");
  EXPECT_EQ(both(1.5e9, 2.0e8), "1.50e+09 +- 2.0e+08");
}

TEST(Rounding, WritesVerySmallNumbersAsPowersOfTen) {
  EXPECT_EQ(both(1.2349e-12, 3.4e-14), "1.235e-12 +- 3.4e-14");
}

TEST(Rounding, PutsNoMinusBeforeAZero) {
  EXPECT_EQ(both(-0.003, 0.13), "0.00 +- 0.13");
}

TEST(Rounding, GivesSixDigitsWithoutAnUncertainty) {
  EXPECT_EQ(both(0.123456789, kNaN), "0.123457 +- -");
  EXPECT_EQ(both(0.5, 0.0), "0.5 +- 0");
  EXPECT_EQ(both(kNaN, 0.1), "- +- 0.1");
}

TEST(Rounding, HasNoPowerOfTenInNumbersOfFourToSevenDigits) {
  EXPECT_EQ(significant(1069.7, 3), "1070");
  EXPECT_EQ(significant(999.7, 3), "1000");
  EXPECT_EQ(significant(-14523.0, 4), "-14520");
  EXPECT_EQ(significant(0.00828, 3), "0.00828");
  EXPECT_EQ(significant(46.42, 3), "46.4");
  EXPECT_EQ(significant(3.8e-5, 2), "3.8e-05");
  EXPECT_EQ(significant(2.0e12, 3), "2e+12");
  EXPECT_EQ(significant(0.0, 3), "0");
  EXPECT_EQ(significant(kNaN, 3), "-");
}

}  // namespace
}  // namespace fogbench::config
