// fit, add, effects and compensate as a user calls them: files in, files and words out.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

class ModelCommandsTest : public FogbenchTest {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string thermal() const {
    return (tests::source_tree() / "config/data/paper-thermal.csv").string();
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
};

TEST_F(ModelCommandsTest, FitOfThePublishedThermalTable) {
  const std::string fitted = path("fitted.json");
  const auto plain = json({"fit", thermal(), "--model", "paper-thermal", "-o", fitted, "--json"});
  ASSERT_EQ(plain.at("estimates").size(), 3U);
  EXPECT_NEAR(plain["estimates"][0]["value"], 1.30551511, 5e-9);
  EXPECT_NEAR(plain["estimates"][1]["value"], -0.11725875, 5e-9);
  EXPECT_NEAR(plain["estimates"][2]["value"], 0.00364289, 5e-9);
  const auto weighted = json({"fit", thermal(), "--model", "paper-thermal", "-o", fitted,
                              "--weight-by", "sigma_deg_per_h", "--json"});
  EXPECT_NEAR(weighted["estimates"][0]["value"], 1.42433146, 5e-9);
  const Finished words = fogbench({"fit", thermal(), "--model", "paper-thermal", "-o", fitted});
  EXPECT_NE(words.out.find("RMS 0.05518 "), std::string::npos) << words.out;
  EXPECT_NE(words.out.find("correlation -0.988: temperature_linear with"), std::string::npos);
  EXPECT_NE(words.out.find("Next: fogbench compare"), std::string::npos);
}

TEST_F(ModelCommandsTest, FittedModelIsAValidInputAndCompensates) {
  const std::string fitted = path("fitted.json"), again = path("again.json");
  ASSERT_EQ(fogbench({"fit", thermal(), "--model", "paper-thermal", "-o", fitted}).status, 0);
  ASSERT_EQ(fogbench({"fit", thermal(), "--model", fitted, "-o", again}).status, 0);
  const std::string out = path("compensated.csv");
  const auto result = json({"compensate", thermal(), "--model", fitted, "-o", out, "--json"});
  EXPECT_NEAR(result.at("rms_after"), 0.05518, 5e-6);
  std::ifstream in(out);
  std::string names;
  std::getline(in, names);
  EXPECT_EQ(names.rfind("compensated_rate_deg_per_h,", 0), 0U);
}

TEST_F(ModelCommandsTest, RunIsFittedByItsNumber) {
  ASSERT_EQ(support::run(dry_run(kQuickSweep, {"--seed", "5"})).status, 0);
  const auto result = json(
      {"fit", "1", "--store", store(), "--model", "magnetic", "-o", path("fitted.json"), "--json"});
  EXPECT_EQ(result.at("estimates").size(), 4U);
  const Finished words =
      fogbench({"fit", "1", "--store", store(), "--model", "magnetic", "-o", path("fitted.json")});
  EXPECT_NE(words.out.find("Next: fogbench compare 1 --store " + store()), std::string::npos)
      << words.out;
}

TEST_F(ModelCommandsTest, EffectsAndAdd) {
  EXPECT_EQ(json({"effects", "--json"}).at("effects").size(), 43U);
  const std::string extended = path("extended.json");
  const Finished added =
      fogbench({"add", "magnetic_hysteresis_z", "--model", "magnetic", "-o", extended});
  EXPECT_EQ(added.status, 0) << added.err;
  EXPECT_TRUE(std::filesystem::exists(extended));
  const auto document =
      json({"add", "bias_step", "--model", extended, "-o", path("again.json"), "--json"});
  EXPECT_EQ(document.at("terms"), 6);
  const std::string nothing = path("nothing.json");
  expect_refused(fogbench({"add", "magnetic_histeresis_z", "--model", "magnetic", "-o", nothing}),
                 3, "did you mean \"magnetic_hysteresis_z\"?");
  expect_refused(fogbench({"add", "bias", "--model", "magnetic", "-o", nothing}), 3, "already");
  EXPECT_FALSE(std::filesystem::exists(nothing));
}

TEST_F(ModelCommandsTest, BadInputWritesNothing) {
  const std::string out = path("out.json");
  const auto refused = [&](const std::string& data, const std::string& says) {
    expect_refused(fogbench({"fit", data, "--model", "thermal", "-o", out}), 3, says);
    EXPECT_FALSE(std::filesystem::exists(out));
  };
  refused(path("no.csv"), "no.csv");
  refused(folder_.path().string(), "directory");
  refused(write("empty.csv", ""), "empty file");
  refused(write("words.csv", "rate_deg_per_h,temperature_c\n1,warm\n"), "words.csv:2: column");
  refused(write("few.csv", "rate_deg_per_h,temperature_c,temperature_rate_c_per_h\n1,21,0\n"),
          "usable rows");
  refused(write("other.csv", "rate_deg_per_h\n1\n"), "column temperature_c");
  expect_refused(fogbench({"fit", thermal(), "--model", "no-such-model", "-o", out}), 3,
                 "no-such-model");
  expect_refused(
      fogbench({"fit", thermal(), "--model", "paper-thermal", "-o", out, "--noise", "pink"}), 2,
      "pink");
  expect_refused(fogbench({"compensate", path("few.csv"), "--model", "thermal", "-o", out}), 3,
                 "no coefficient");
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace fogbench::system_tests
