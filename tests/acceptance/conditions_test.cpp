#include "acceptance/conditions.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fogbench::acceptance {
namespace {

using procedures::Point;

/// A sweep along X at 21 degC, then set points without field.
std::vector<Point> acceptance_points() {
  std::vector<Point> points;
  for (const double level : {0.0, 300.0, -300.0}) {
    Point point;
    point.temperature_c = 21.1;
    point.field_set_ut = level;
    point.field_x_ut = level + 0.02;
    points.push_back(point);
  }
  for (const double temperature : {31.0, 55.04}) {
    Point point;
    point.temperature_c = temperature;
    point.field_set_ut = std::nan("");
    point.field_x_ut = 20.0;  // the room's
    points.push_back(point);
  }
  return points;
}

TEST(Conditions, OfAFieldsEffectAreThoseOfItsSweep) {
  const auto points = acceptance_points();
  for (const char* quantity : {"magnetic_linear_x", "K_x"}) {
    EXPECT_EQ(conditions_text(conditions_of(quantity, points), "degC", "uT"),
              "21 degC, OX -300..300 uT")
        << quantity;
  }
}

TEST(Conditions, OfOtherEffectsAreThoseOutsideSweeps) {
  const auto points = acceptance_points();
  EXPECT_EQ(conditions_text(conditions_of("temperature_linear", points), "degC", "uT"),
            "31..55 degC, 0 uT");
}

TEST(Conditions, OfAnAxisThatNobodySweptAreTheTemperaturesAlone) {
  const auto points = acceptance_points();
  EXPECT_TRUE(std::isnan(conditions_of("magnetic_linear_y", points).field_low_ut));
  EXPECT_EQ(conditions_text({}, "degC", "uT"), "");
}

TEST(Quantity, IsACoefficientOrAnAcceptancesOwn) {
  for (const char* name : {"bias", "earth_rate_projection.cos", "K_z", "temperature_sigma"}) {
    EXPECT_TRUE(is_quantity(name)) << name;
  }
  for (const char* name : {"bais", "K_w", "", "sigma"}) EXPECT_FALSE(is_quantity(name)) << name;
}

}  // namespace
}  // namespace fogbench::acceptance
