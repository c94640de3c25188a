#include "config/nearest_name.hpp"

#include <gtest/gtest.h>

namespace fogbench::config {
namespace {

TEST(EditsBetween, CountsInsertionsDeletionsAndReplacements) {
  EXPECT_EQ(edits_between("bias", "bias"), 0U);
  EXPECT_EQ(edits_between("", "bias"), 4U);
  EXPECT_EQ(edits_between("bias", "bias_step"), 5U);
  EXPECT_EQ(edits_between("kitten", "sitting"), 3U);
}

TEST(NearestName, IsWithinAThirdOfTheLetters) {
  const std::vector<std::string_view> known = {"temperature_linear", "bias", "target_c"};
  EXPECT_EQ(nearest_name("temprature_liner", known), "temperature_linear");
  EXPECT_EQ(nearest_name("target", known), "target_c");
  EXPECT_EQ(nearest_name("frequency", known), "");
  EXPECT_EQ(nearest_name("", known), "");
}

TEST(DidYouMean, OffersTheNearestOrTheFamilyOrNothing) {
  const std::vector<std::string_view> known = {"magnetic_hysteresis_x", "temperature_hysteresis",
                                               "bias", "maximum"};
  EXPECT_EQ(did_you_mean("bais", known), "; did you mean \"bias\"?");
  EXPECT_EQ(did_you_mean("max", known), "; did you mean \"maximum\"?");
  EXPECT_EQ(did_you_mean("hysteresis", known),
            "; did you mean one of \"magnetic_hysteresis_x\", \"temperature_hysteresis\"?");
  EXPECT_EQ(did_you_mean("frequency", known), "");
  EXPECT_EQ(did_you_mean("", known), "");
}

}  // namespace
}  // namespace fogbench::config
