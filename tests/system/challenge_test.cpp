// challenge and reveal as a user calls them: a folder appears, its answer does not, and the right
// answer is told from a wrong one.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

class ChallengeTest : public FogbenchTest {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Makes the challenge of that seed.
  std::string make(const std::string& seed) const {
    const auto made = json({"challenge", "--seed", seed, "-o", path(seed), "--json"});
    EXPECT_EQ(made.at("folder"), path(seed));
    return path(seed);
  }
  static void append(const std::string& file, const std::string& text) {
    std::ofstream(file, std::ios::app) << text;
  }
};

TEST_F(ChallengeTest, TheRightAnswerIsTheOneThatIsRevealed) {
  // Between them: nothing hidden, one effect and two.
  std::set<std::size_t> counts;
  for (const char* seed : {"2", "11", "13"}) {
    const std::string made = make(seed);
    const auto revealed = json({"reveal", made, "--json"});
    EXPECT_EQ(revealed.at("seed"), seed);
    EXPECT_FALSE(revealed.contains("exact"));
    std::vector<std::string> right{"reveal", made, "--answer"}, names;
    for (const auto& hidden : revealed.at("hidden")) {
      names.push_back(hidden.at("effect"));
      EXPECT_GT(hidden.at("visible_deg_per_h"), 2.9 * revealed.at("noise_deg_per_h").get<double>());
      EXPECT_NE(hidden.at("unit"), "");
    }
    counts.insert(names.size());
    if (names.empty()) names.emplace_back("nothing");
    right.insert(right.end(), names.begin(), names.end());
    const Finished exact = fogbench(right);
    EXPECT_EQ(exact.status, 0) << exact.err;
    EXPECT_NE(exact.out.find("Exactly right."), std::string::npos) << exact.out;
    const Finished wrong = fogbench({"reveal", made, "--answer", "magnetic_cross_xy"});
    EXPECT_EQ(wrong.status, 1);
    EXPECT_EQ(wrong.err, "");
    EXPECT_NE(wrong.out.find("invented      magnetic_cross_xy"), std::string::npos) << wrong.out;
  }
  EXPECT_EQ(counts.size(), 3U);
}

TEST_F(ChallengeTest, TheFolderHasDataAndAModelThatFitThem) {
  const Finished made = fogbench({"challenge", "--seed", "2", "-o", path("2") + "/"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(made.err, "");
  const std::string data = path("2") + "/measurements.csv", model = path("2") + "/model.json";
  EXPECT_NE(made.out.find("Next: fogbench compare " + data + " --model " + model),
            std::string::npos)
      << made.out;
  const auto fitted = json({"fit", data, "--model", model, "-o", path("fitted.json"), "--noise",
                            "independent", "--json"});
  EXPECT_EQ(fitted.at("estimates").size(), 2U);
  // What the model leaves is what was said to hide, and the noise.
  const auto revealed = json({"reveal", path("2"), "--json"});
  const double visible = revealed.at("hidden").at(0).at("visible_deg_per_h");
  const double noise = revealed.at("noise_deg_per_h");
  EXPECT_NEAR(fitted.at("rms"), std::hypot(visible, noise), noise / 2.0);
  EXPECT_EQ(folder_.entries(), 2U) << "the challenge and the fitted model, nothing left behind";
}

TEST_F(ChallengeTest, OneSeedGivesTheSameBytes) {
  ASSERT_EQ(fogbench({"challenge", "--seed", "9", "-o", path("a")}).status, 0);
  ASSERT_EQ(fogbench({"challenge", "--seed", "9", "-o", path("b")}).status, 0);
  for (const char* name : {"/measurements.csv", "/model.json", "/sealed.json"}) {
    EXPECT_EQ(support::read_text(path("a") + name), support::read_text(path("b") + name)) << name;
  }
}

TEST_F(ChallengeTest, ADrawnSeedIsNotShown) {
  const Finished made = fogbench({"challenge", "-o", path("drawn")});
  ASSERT_EQ(made.status, 0) << made.err;
  const std::string seed = json({"reveal", path("drawn"), "--json"}).at("seed");
  EXPECT_EQ(made.out.find(seed), std::string::npos);
  EXPECT_EQ(made.err.find(seed), std::string::npos);
  EXPECT_EQ(support::read_text(path("drawn") + "/sealed.json").find('"' + seed + '"'),
            std::string::npos);
}

TEST_F(ChallengeTest, ADiagnosisIsScored) {
  const std::string made = make("2");
  const std::string hidden = json({"reveal", made, "--json"}).at("hidden").at(0).at("effect");
  const std::string named =
      folder_.file("named.json", R"({"verdict": "missing_effect", "missing": [{"effect": ")" +
                                     hidden + R"("}]})");
  EXPECT_EQ(fogbench({"reveal", made, "--diagnosis", named}).status, 0);
  const std::string adequate = folder_.file("adequate.json", R"({"verdict": "adequate"})");
  const Finished missed = fogbench({"reveal", made, "--diagnosis", adequate, "--json"});
  EXPECT_EQ(missed.status, 1);
  EXPECT_EQ(nlohmann::json::parse(missed.out).at("missed").at(0), hidden);
  expect_refused(fogbench({"reveal", made, "--diagnosis", path("none.json")}), 3, "none.json");
  EXPECT_EQ(fogbench({"reveal", made, "--diagnosis", named, "--answer", hidden}).status, 2);
}

TEST_F(ChallengeTest, ARowThatOnlyTheMissingEffectMakesLookBadIsBelieved) {
  // The gradient is gone after the first row: beside the model as it came that row alone is off.
  const std::string made = make("23");
  const auto diagnosis =
      json({"diagnose", made + "/measurements.csv", "--model", made + "/model.json", "--json"});
  EXPECT_EQ(diagnosis.at("missing").at(0).at("effect"), "temperature_gradient");
  EXPECT_TRUE(diagnosis.at("left_out").empty()) << diagnosis.at("left_out").dump();
}

TEST_F(ChallengeTest, WhatWasTamperedWithStaysShut) {
  const std::string made = make("2");
  expect_refused(fogbench({"reveal", made, "--answer", "warmup"}), 3, "warm_up");
  append(made + "/measurements.csv", "\n");
  expect_refused(fogbench({"reveal", made}), 3, "measurements.csv: found SHA-256");
  std::filesystem::resize_file(made + "/sealed.json", 100);
  expect_refused(fogbench({"reveal", made}), 3, "sealed.json: line");
  std::filesystem::remove(made + "/sealed.json");
  expect_refused(fogbench({"reveal", made}), 3, "sealed.json");
  expect_refused(fogbench({"reveal", path("none")}), 3, "none/sealed.json");
}

TEST_F(ChallengeTest, NothingIsOverwritten) {
  std::filesystem::create_directory(path("full"));
  const auto mine = folder_.file("full/mine.txt", "mine");
  expect_refused(fogbench({"challenge", "--seed", "2", "-o", path("full")}), 3, "has content");
  expect_refused(fogbench({"challenge", "--seed", "2", "-o", mine}), 3, "is a file");
  expect_refused(fogbench({"challenge", "--seed", "2", "-o", path("none/there")}), 3,
                 "cannot be made");
  EXPECT_EQ(support::read_text(mine), "mine");
  EXPECT_EQ(folder_.entries(), 1U);
  std::filesystem::create_directory(path("empty"));
  EXPECT_EQ(fogbench({"challenge", "--seed", "2", "-o", path("empty")}).status, 0);
  EXPECT_TRUE(std::filesystem::exists(path("empty") + "/sealed.json"));
}

}  // namespace
}  // namespace fogbench::system_tests
