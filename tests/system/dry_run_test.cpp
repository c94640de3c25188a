// Real processes: that a dry run, its record and its exports hang together, and repeat.

#include <algorithm>
#include <csignal>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

using support::read_text;

TEST_F(FogbenchTest, ADryRunGoesFromPlanToExport) {
  const Finished plan = fogbench({"plan", "coil-sweep"});
  EXPECT_EQ(plan.status, 0) << plan.err;
  EXPECT_NE(plan.out.find("Limits met"), std::string::npos);

  const Finished done = support::run(dry_run(kQuickSweep, {"--seed", "7"}));
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_NE(done.out.find("seed 7"), std::string::npos);
  EXPECT_NE(done.out.find("Magnetic coefficients"), std::string::npos);
  EXPECT_NE(done.out.find("Run 1 is in " + store()), std::string::npos);

  const auto runs = json({"runs", "--store", store(), "--json"});
  ASSERT_EQ(runs["runs"].size(), 1U);
  EXPECT_EQ(runs["runs"][0]["outcome"], "completed");
  EXPECT_EQ(runs["runs"][0]["seed"], 7);

  const auto shown = json({"show", "1", "--store", store(), "--json"});
  EXPECT_EQ(shown["measured"].size(), 17U);  // two baselines, three sweeps of five
  EXPECT_EQ(shown["results"]["sweeps"].size(), 3U);
  EXPECT_EQ(shown["instruments"].size(), 6U);
  EXPECT_EQ(shown["safe_state_reached"], true);
  EXPECT_TRUE(shown["events"].empty()) << "an interlock that trips on a sound bench is a defect";
  // The hidden coefficient of the scenario `clean` along z, far above the noise of 3 s averages.
  EXPECT_NEAR(shown["results"]["sweeps"][2]["k_deg_per_h_per_100_ut"]["value"], -0.25, 0.06);

  const std::string csv = (folder_ / "points.csv").string(), raw = (folder_ / "raw.csv").string();
  EXPECT_EQ(fogbench({"export", "1", "--store", store(), "-o", csv}).status, 0);
  EXPECT_EQ(fogbench({"export", "1", "--store", store(), "--raw", "-o", raw}).status, 0);
  const std::string points = read_text(csv), frames = read_text(raw);
  EXPECT_EQ(std::count(points.begin(), points.end(), '\n'), 18);
  EXPECT_EQ(std::count(frames.begin(), frames.end(), '\n'),
            shown["frames_stored"].get<std::int64_t>() + 1);
  EXPECT_EQ(fogbench({"export", "1", "--store", store()}).out, points);
}

TEST_F(FogbenchTest, AListOfAParameterMayHaveBlanks) {
  const std::string compact = fogbench({"plan", "coil-sweep", "--set", "levels_ut=0,50,100"}).out;
  EXPECT_NE(compact.find("100 uT"), std::string::npos) << compact;
  const std::vector<std::vector<std::string>> written{
      {"--set", "levels_ut=0, 50, 100"},        // quoted
      {"--set", "levels_ut=0,", "50,", "100"},  // as the shell takes it apart
      {"--set=levels_ut=", "0", ",50", ",100"},
  };
  for (const auto& set : written) {
    std::vector<std::string> arguments{"plan"};
    arguments.insert(arguments.end(), set.begin(), set.end());
    arguments.push_back("coil-sweep");
    const Finished plan = fogbench(arguments);
    EXPECT_EQ(plan.status, 0) << plan.err;
    EXPECT_EQ(plan.out, compact);
  }
}

TEST_F(FogbenchTest, AnEditedCopyOfAReadyProcedureIsToldFromItWhereverARunIsNamed) {
  const auto ready = tests::source_tree() / "config/procedures/static-record.json";
  auto edited = nlohmann::json::parse(read_text(ready));
  edited["parameters"]["duration_s"] = 20;
  edited["parameters"]["average_s"] = 10;
  const auto copy = folder_.file("static-record.json", edited.dump());
  const std::string name = "static-record (static-record.json, not the ready one)";
  EXPECT_NE(fogbench({"plan", copy.string()}).out.find(name), std::string::npos);
  const Finished done = fogbench({"dry-run", copy.string(), "--seed", "1", "--store", store()});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(json({"runs", "--store", store(), "--json"})["runs"][0]["procedure"], name);
  EXPECT_NE(fogbench({"show", "1", "--store", store()}).out.find(name), std::string::npos);
}

TEST_F(FogbenchTest, OneSeedGivesTheSameBytesAndAnotherOneOthers) {
  for (const char* seed : {"3", "3", "4"}) {
    ASSERT_EQ(support::run(dry_run(kQuickSweep, {"--seed", seed})).status, 0);
  }
  const auto exported = [&](const char* run, bool raw) {
    std::vector<std::string> arguments{"export", run, "--store", store()};
    if (raw) arguments.push_back("--raw");
    return fogbench(arguments).out;
  };
  for (const bool raw : {false, true}) {
    EXPECT_GT(exported("1", raw).size(), 1000U);
    EXPECT_EQ(exported("1", raw), exported("2", raw));
    EXPECT_NE(exported("1", raw), exported("3", raw));
  }
  const auto runs = json({"show", "1", "--store", store(), "--json"});
  EXPECT_EQ(runs["raw_sha256"], json({"show", "2", "--store", store(), "--json"})["raw_sha256"]);
}

TEST_F(FogbenchTest, ASeedThatNobodyGaveIsPrintedRecordedAndRepeats) {
  ASSERT_EQ(support::run(dry_run(kQuickSweep)).status, 0);
  const auto first = json({"show", "1", "--store", store(), "--json"});
  const std::string seed = std::to_string(first["seed"].get<std::uint64_t>());
  ASSERT_EQ(support::run(dry_run(kQuickSweep, {"--seed", seed})).status, 0);
  EXPECT_EQ(first["raw_sha256"], json({"show", "2", "--store", store(), "--json"})["raw_sha256"]);
}

TEST_F(FogbenchTest, JsonIsOneDocumentAndNothingElse) {
  const Finished done = support::run(dry_run(kQuickSweep, {"--json"}));
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(nlohmann::json::parse(done.out)["outcome"], "completed");
  EXPECT_EQ(done.err, "");
  EXPECT_GT(json({"plan", "coil-sweep", "--json"})["steps"].size(), 70U);
}

TEST_F(FogbenchTest, TwoProgramsMayWriteOneStore) {
  Process first(dry_run(kQuickSweep)), second(dry_run(kQuickSweep));
  EXPECT_EQ(first.wait().status, 0);
  EXPECT_EQ(second.wait().status, 0);
  EXPECT_EQ(json({"runs", "--store", store(), "--json"})["runs"].size(), 2U);
}

TEST_F(FogbenchTest, TheDefaultStoreIsTheUsersOwn) {
  auto arguments = command({"dry-run"});
  arguments.insert(arguments.end(), kQuickSweep.begin(), kQuickSweep.end());
  const std::string path = (folder_ / "state" / "store.db").string();
  const Process::Setup setup{{"FOGBENCH_STORE=" + path}, {}};
  EXPECT_EQ(support::run(arguments, setup).status, 0);
  EXPECT_EQ(fogbench({"show", "1"}, setup).status, 0);
}

class DaemonTest : public FogbenchTest {};

TEST_F(DaemonTest, RunsItsProceduresInTheirOrder) {
  const Finished done = support::run(command({"--bench", "simulated", "--speed", "max", "--store",
                                              store(), "static-record", "static-record"},
                                             "fogbenchd"));
  EXPECT_EQ(done.status, 0) << done.err;
  const auto runs = json({"runs", "--store", store(), "--json"});
  ASSERT_EQ(runs["runs"].size(), 2U);
  EXPECT_EQ(runs["runs"][1]["outcome"], "completed");
  EXPECT_NE(done.err.find("safe state"), std::string::npos);
}

TEST_F(DaemonTest, TouchesNothingWhenOneOfItsProceduresIsWrong) {
  const Finished done = support::run(
      command({"--bench", "simulated", "--store", store(), "coil-sweep", "no-such"}, "fogbenchd"));
  EXPECT_EQ(done.status, 3) << done.err;
  EXPECT_EQ(folder_.entries(), 0U);
}

TEST_F(DaemonTest, ARealBenchWhoseInstrumentsAreNotThereEndsInOneLine) {
  const Finished done =
      support::run(command({"--bench", "factory", "--store", store(), "coil-sweep"}, "fogbenchd"));
  EXPECT_EQ(done.status, 4) << done.err;
  EXPECT_NE(done.err.find("coil_horizontal: "), std::string::npos) << done.err;
  EXPECT_EQ(folder_.entries(), 0U);
}

TEST_F(DaemonTest, WhatIsOfTheSimulatedBenchIsRefusedOnARealOne) {
  for (const std::vector<std::string>& option :
       {std::vector<std::string>{"--seed", "1"}, {"--speed", "max"}, {"--scenario", "device-1"}}) {
    std::vector<std::string> words{"--bench", "factory", "--store", store(), "coil-sweep"};
    words.insert(words.end(), option.begin(), option.end());
    const Finished done = support::run(command(words, "fogbenchd"));
    EXPECT_EQ(done.status, 2) << done.err;
    EXPECT_NE(done.err.find("are for the simulated bench; bench factory is a real one"),
              std::string::npos)
        << done.err;
    EXPECT_EQ(folder_.entries(), 0U);
  }
}

}  // namespace
}  // namespace fogbench::system_tests
