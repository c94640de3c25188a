#include "config/column_unit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fogbench::config {
namespace {

std::string unit_named_in(std::string_view column) {
  const auto unit = unit_in_name(column);
  if (!unit) return "error";
  return *unit == nullptr ? "none" : std::string((*unit)->name);
}

TEST(UnitInName, IsReadFromBracketsAndFromTheNamesEnd) {
  for (const auto& [column, unit] :
       std::vector<std::pair<const char*, const char*>>{{"gyro [deg/s]", "deg/s"},
                                                        {"T (K)", "K"},
                                                        {"omega_rad_s", "rad/s"},
                                                        {"B_nT", "nT"},
                                                        {"time_ms", "ms"},
                                                        {"t_h", "h"},
                                                        {"rate_deg_per_h", "deg/h"},
                                                        {"rate_mdeg_per_s", "mdeg/s"},
                                                        {"omega", "none"},
                                                        {"segment", "none"},
                                                        {"field [ nT ]", "nT"},
                                                        {"gyro [furlong]", "error"},
                                                        {"angle_mrad", "mrad"},
                                                        {"", "none"}}) {
    EXPECT_EQ(unit_named_in(column), unit) << column;
  }
}

TEST(UnitInName, AnUnknownUnitComesWithTheKnownOnes) {
  const auto unit = unit_in_name("gyro [furlong]");
  ASSERT_FALSE(unit);
  EXPECT_EQ(unit.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(unit.error().message,
              testing::HasSubstr("found the unit \"furlong\", expected one of"));
  EXPECT_THAT(unit.error().message, testing::HasSubstr("arcsec/s"));
}

}  // namespace
}  // namespace fogbench::config
