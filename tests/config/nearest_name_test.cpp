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

}  // namespace
}  // namespace fogbench::config
