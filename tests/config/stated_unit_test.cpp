#include "config/stated_unit.hpp"

#include <gtest/gtest.h>

namespace fogbench::config {
namespace {

/// What a number in the stated unit is in the house's.
double in_house(std::string_view unit, double stated) {
  const StatedUnit* const found = find_unit(unit);
  if (found == nullptr) {
    ADD_FAILURE() << unit;
    return 0.0;
  }
  return stated * found->factor + found->offset;
}

TEST(StatedUnit, IsWorthWhatTheTextbookSays) {
  EXPECT_NEAR(in_house("deg/s", 0.001), 3.6, 1e-12);
  EXPECT_NEAR(in_house("rad/s", 7.292115e-5), 15.041067, 1e-6);  // the Earth's
  EXPECT_NEAR(in_house("mrad/s", 1.0), 206.264806, 1e-6);
  EXPECT_NEAR(in_house("arcsec/s", 15.0), 15.0, 1e-12);
  EXPECT_NEAR(in_house("rpm", 1.0), 21600.0, 1e-9);
  EXPECT_NEAR(in_house("K", 293.15), 20.0, 1e-9);
  EXPECT_NEAR(in_house("degF", 32.0), 0.0, 1e-9);
  EXPECT_NEAR(in_house("degF", -40.0), -40.0, 1e-9);
  EXPECT_NEAR(in_house("mdegC", 25125.0), 25.125, 1e-9);
  EXPECT_NEAR(in_house("nT", 48000.0), 48.0, 1e-9);
  EXPECT_NEAR(in_house("G", 0.5), 50.0, 1e-12);
  EXPECT_NEAR(in_house("mT", 0.32), 320.0, 1e-9);
  EXPECT_NEAR(in_house("mA", 250.0), 0.25, 1e-12);
  EXPECT_NEAR(in_house("kW", 0.012), 12.0, 1e-12);
  EXPECT_NEAR(in_house("rad", 1.5707963267948966), 90.0, 1e-9);
  EXPECT_NEAR(in_house("m/s^2", 9.80665), 1.0, 1e-12);
}

TEST(StatedUnit, TheHousesOfEachKindChangesNothing) {
  for (const Dimension dimension :
       {Dimension::kRate, Dimension::kTemperature, Dimension::kField, Dimension::kCurrent,
        Dimension::kPower, Dimension::kAngle, Dimension::kAcceleration, Dimension::kVoltage,
        Dimension::kTime, Dimension::kFrequency, Dimension::kShare}) {
    EXPECT_EQ(in_house(house_unit(dimension), 1.25), 1.25) << house_unit(dimension);
    EXPECT_NE(known_units(dimension).find(house_unit(dimension)), std::string::npos);
  }
}

TEST(StatedUnit, SpellingCounts) {
  EXPECT_EQ(find_unit("banana"), nullptr);
  EXPECT_EQ(find_unit("DEG/S"), nullptr);
  EXPECT_EQ(find_unit(""), nullptr);
}

}  // namespace
}  // namespace fogbench::config
