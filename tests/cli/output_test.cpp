#include "cli/output.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace fogbench::cli {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(TextTable, AlignsNumbersRightUnderTheirUnits) {
  TextTable table({{"axis", "", TextTable::Align::kLeft}, {"rate", "deg/h"}});
  EXPECT_TRUE(table.empty());
  table.add_row({"x", "-0.5"});
  table.add_row({"longer", "10.25"});
  EXPECT_FALSE(table.empty());
  EXPECT_EQ(table.text(),
            "axis     rate\n"
            "        deg/h\n"
            "-------------\n"
            "x        -0.5\n"
            "longer  10.25\n");
}

TEST(TextTable, HasNoUnitLineWithoutUnits) {
  TextTable table(std::vector<TextTable::Column>{{"a", ""}});
  table.add_row({"12"});
  EXPECT_EQ(table.text(), " a\n--\n12\n");
}

TEST(Numbers, AreFixedAndMissingOnesADash) {
  EXPECT_EQ(fixed(1.23456, 2), "1.23");
  EXPECT_EQ(fixed(kNaN, 2), "-");
}

TEST(Numbers, AreGivenToTwoDigitsOfTheirError) {
  EXPECT_EQ(with_error(-0.25318, 0.00096), "-0.25318 +- 0.00096");
  EXPECT_EQ(with_error(1.5, 0.13), "1.50 +- 0.13");
  EXPECT_EQ(with_error(1234.5, 20.0), "1234 +- 20");
  EXPECT_EQ(with_error(0.5, kNaN), "0.5");
  EXPECT_EQ(with_error(kNaN, kNaN), "-");
}

TEST(Errors, AreOneLineWhateverTheMessage) {
  testing::internal::CaptureStderr();
  print_error("two\nlines\tand a bell\a");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "fogbench: two lines and a bell \n");
}

}  // namespace
}  // namespace fogbench::cli
