#include "config/units.hpp"

#include <gtest/gtest.h>

#include <iterator>

namespace fogbench::config {
namespace {

TEST(Units, SuffixSaysTheUnit) {
  EXPECT_EQ(unit_of("field_x_ut"), "uT");
  EXPECT_EQ(unit_of("rate_deg_per_h"), "deg/h");
  EXPECT_EQ(unit_of("temperature_rate_c_per_h"), "degC/h");
  EXPECT_EQ(unit_of("bias_instability_deg_per_h"), "deg/h");
  EXPECT_EQ(unit_of("rate_random_walk_deg_per_h_per_sqrt_h"), "deg/h/sqrt(h)");
  EXPECT_EQ(unit_of("angle_random_walk_deg_per_sqrt_h"), "deg/sqrt(h)");
  EXPECT_EQ(unit_of("coil_ut_per_a"), "uT/A");
  EXPECT_EQ(unit_of("gradient_c_per_w"), "degC/W");
  EXPECT_EQ(unit_of("temperature_acceleration_c_per_h2"), "degC/h^2");
  EXPECT_EQ(unit_of("ambient_steps_per_h"), "1/h");
  EXPECT_EQ(unit_of("settle_s"), "s");
  EXPECT_EQ(unit_of("run"), "");
  EXPECT_EQ(unit_of(""), "");
}

TEST(Units, NoSuffixHidesALaterOne) {
  for (auto entry = std::begin(kUnitSuffixes); entry != std::end(kUnitSuffixes); ++entry) {
    EXPECT_EQ(unit_of(entry->suffix), entry->unit) << entry->suffix;
  }
}

TEST(Units, QuantitiesOfOneUnitAddAndCompare) {
  EXPECT_EQ(Celsius{20} + Celsius{1.5}, Celsius{21.5});
  EXPECT_EQ(Microtesla{300} / Microtesla{100}, 3.0);
  EXPECT_LT(-Ampere{2}, Ampere{1});
  EXPECT_EQ(2.0 * Watt{3} - Watt{1}, Watt{5});
  EXPECT_EQ(Degree{90} / 2.0, Degree{45});
}

TEST(Units, AnglesAreApartAsDirectionsAre) {
  EXPECT_EQ(angle_between(Degree{90}, Degree{-270}).value, 0.0);
  EXPECT_EQ(angle_between(Degree{359}, Degree{2}).value, 3.0);
  EXPECT_EQ(angle_between(Degree{0}, Degree{180}).value, 180.0);
}

}  // namespace
}  // namespace fogbench::config
