// compare and allan as a user types them, on the published tables: what their own words must say,
// the exit status, and bad input. A unit test sees neither the loading nor the printing.

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "tests/support/markup.hpp"
#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

using testing::HasSubstr;

std::string published(const std::string& name) {
  return (tests::source_tree() / "config" / "data" / name).string();
}

TEST_F(FogbenchTest, CompareShowsThatThePublishedModelMissesThePublishedTable) {
  const Finished done =
      fogbench({"compare", published("paper-thermal.csv"), "--model", "paper-thermal", "--as-is"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("At 55 degC the model is 0.585 deg/h above the measurements"));
  EXPECT_THAT(done.out, HasSubstr("the model gives 2.149, the measurements 1.564 deg/h"));
  EXPECT_THAT(done.out, HasSubstr("temperature_quadratic (0.004 +- 0.0005) moves the model there"));
}

TEST_F(FogbenchTest, CompareExitsWithOneOnlyWhenAskedToCheck) {
  const std::vector<std::string> held{
      "compare", published("paper-thermal.csv"), "--model", "paper-thermal", "--as-is", "--check"};
  EXPECT_EQ(fogbench(held).status, 1);
  const nlohmann::json document = json(
      {"compare", published("paper-thermal.csv"), "--model", "paper-thermal", "--check", "--json"});
  EXPECT_TRUE(document["adequate"].get<bool>());
  EXPECT_NEAR(document["fit"]["rms_deg_per_h"].get<double>(), 0.05518, 1e-5);
}

TEST_F(FogbenchTest, CompareSaysWhatTheTwoMagneticTestsTell) {
  const Finished first =
      fogbench({"compare", published("paper-magnetic-device1.csv"), "--model", "paper-magnetic"});
  EXPECT_THAT(first.out, HasSubstr("mean -0.003 +- 0.03 deg/h per 100 uT (95 %): not "
                                   "distinguishable from zero"));
  EXPECT_THAT(first.out, HasSubstr("mean -0.001 +- 0.03 deg/h per 100 uT (95 %): not "
                                   "distinguishable from zero"));
  const Finished second =
      fogbench({"compare", published("paper-magnetic-device2.csv"), "--model", "paper-magnetic"});
  EXPECT_THAT(second.out, HasSubstr("shrank together: one common scale 0.64 +- 0.03"));
  EXPECT_THAT(second.out, HasSubstr("their direction is kept to 3.8 deg. That is not noise"));
}

TEST_F(FogbenchTest, CompareSaysBeforeTheWorkThatAReportCannotBeWritten) {
  const std::string page = (folder_ / "no" / "such.html").string();
  // The data do not exist either: which of the two is told shows which was looked at first.
  for (const std::string command : {"compare", "diagnose"}) {
    expect_refused(fogbench({command, "missing.csv", "--model", "thermal", "--report", page}), 3,
                   page);
  }
}

TEST_F(FogbenchTest, CompareWritesAReport) {
  const std::string page = (folder_ / "page.html").string();
  ASSERT_EQ(fogbench({"compare", published("paper-thermal.csv"), "--model", "paper-thermal",
                      "--as-is", "--report", page})
                .status,
            0);
  std::ifstream file(page);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(text, HasSubstr("</html>"));
  EXPECT_THAT(text, HasSubstr("<svg"));
}

TEST_F(FogbenchTest, DiagnoseWritesAReportOrSaysWhyNot) {
  const std::string page = (folder_ / "page.html").string();
  const Finished done = fogbench(
      {"diagnose", published("paper-thermal.csv"), "--model", "paper-thermal", "--report", page});
  ASSERT_EQ(done.status, 0) << done.err;
  std::ifstream file(page);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(support::markup_error(text), "");
  EXPECT_THAT(text, HasSubstr("Residual by temperature, degC"));
  expect_refused(fogbench({"diagnose", published("paper-thermal.csv"), "--model", "paper-thermal",
                           "--report", (folder_ / "none" / "page.html").string()}),
                 3, "page.html");
}

TEST_F(FogbenchTest, CompareRefusesWhatItCannotUse) {
  expect_refused(fogbench({"compare", published("paper-thermal.csv")}), 2, "--model");
  expect_refused(fogbench({"compare", published("paper-thermal.csv"), "--model", "no-such"}), 3,
                 "no-such");
  expect_refused(fogbench({"compare", "no-such.csv", "--model", "thermal"}), 3, "no-such.csv");
  expect_refused(fogbench({"compare", published("paper-thermal.csv"), "--model", "paper-magnetic"}),
                 3, "field_x_ut");
}

TEST_F(FogbenchTest, CompareDashesWhatTheDataCannotDetermine) {
  const std::string data =
      folder_.file("flat.csv", "rate_deg_per_h,temperature_c\n1,21\n2,21\n1,21\n2,21\n").string();
  const Finished done = fogbench({"compare", data, "--model", "paper-thermal"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, testing::Not(HasSubstr("nan")));
}

TEST_F(FogbenchTest, AllanReadsTheNoiseOfARecord) {
  const std::string record = (folder_ / "record.csv").string();
  std::ofstream file(record);
  file << "time_s,rate_deg_per_h\n";
  unsigned state = 1;  // uniform numbers: white, standard deviation 1/sqrt(12)
  for (int i = 0; i < 20000; ++i) {
    state = state * 1664525u + 1013904223u;
    file << 10 * i << ',' << state / 4294967296.0 << '\n';
  }
  file.close();
  const nlohmann::json document = json({"allan", record, "--json"});
  const double expected = std::sqrt(1.0 / 12.0 * 10.0 / 3600.0);
  EXPECT_NEAR(document["noise"]["N_deg_per_sqrt_h"].get<double>(), expected, 0.03 * expected);
  EXPECT_EQ(document["interval_s"].get<double>(), 10.0);
  EXPECT_THAT(fogbench({"allan", record}).out, HasSubstr("angle random walk N"));
  expect_refused(fogbench({"allan", published("paper-thermal.csv")}), 3, "no column time_s");
}

}  // namespace
}  // namespace fogbench::system_tests
