// A person's own procedure, from its file to the points, through the executable: each as the
// procedures' README says it, and no step more.

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

class OwnProcedureTest : public FogbenchTest {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    const auto file = folder_ / name;
    std::ofstream(file) << text;
    return file.string();
  }
  static std::size_t longest_line(const std::string& text) {
    std::istringstream lines(text);
    std::size_t longest = 0;
    for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
    return longest;
  }
  /// The temperatures of the points of each segment, as they are exported.
  std::map<std::string, std::vector<double>> measured() const {
    std::istringstream lines(fogbench({"export", "1", "--store", store()}).out);
    const auto cells_of = [](const std::string& line) {
      std::vector<std::string> cells;
      std::istringstream row(line);
      for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
      return cells;
    };
    std::string line;
    std::getline(lines, line);
    const auto names = cells_of(line);
    const auto column = [&names](const char* name) {
      const auto found = std::find(names.begin(), names.end(), name);
      EXPECT_NE(found, names.end()) << name;
      return static_cast<std::size_t>(found - names.begin());
    };
    const std::size_t segment = column("segment"), temperature = column("temperature_c");
    std::map<std::string, std::vector<double>> temperatures;
    while (std::getline(lines, line)) {
      const auto cells = cells_of(line);
      temperatures[cells.at(segment)].push_back(std::stod(cells.at(temperature)));
    }
    return temperatures;
  }
};

TEST_F(OwnProcedureTest, ThreeCyclesAtTwoDegreesAMinuteWithStaticEndsAndALoopAtFifty) {
  const std::string mine = write("mine.json", R"({"name": "mine", "steps": [
    {"step": "ramp", "to_c": 25, "rate_c_per_h": 120, "settle": true},
    {"step": "repeat", "times": 3, "steps": [
      {"step": "ramp", "to_c": 55, "rate_c_per_h": 120, "segment": "cycle/up", "window_s": 30},
      {"step": "wait", "duration_s": 600, "segment": "cycle/high"},
      {"step": "ramp", "to_c": 25, "rate_c_per_h": 120, "segment": "cycle/down", "window_s": 30},
      {"step": "wait", "duration_s": 600, "segment": "cycle/low"}]},
    {"step": "ramp", "to_c": 50, "rate_c_per_h": 120, "settle": true},
    {"step": "compensate_field"},
    {"step": "sweep", "axis": "x", "levels_ut": [0, 300, 0, -300, 0], "duration_s": 60,
     "segment": "coil_x"}]})");
  // The everyday bench cannot: it says where it stops following, and what it could.
  const Finished refused = fogbench({"plan", mine});
  expect_refused(refused, 3, "a ramp from 21 to 25 degC at 120 degC/h, which the heaters cannot");
  EXPECT_NE(refused.err.find("the nearest rate that goes all the way is 48 degC/h"),
            std::string::npos)
      << refused.err;

  const Finished checked = fogbench({"procedure", "check", mine, "--bench", "simulated-chamber"});
  EXPECT_EQ(checked.status, 0) << checked.err;
  const Finished plan = fogbench({"plan", mine, "--bench", "simulated-chamber"});
  EXPECT_EQ(plan.status, 0) << plan.err;
  EXPECT_NE(plan.out.find("turn 3 of 3: cycle/up, cycle/high, cycle/down,"), std::string::npos)
      << plan.out;
  EXPECT_NE(plan.out.find("245 points"), std::string::npos) << plan.out;
  EXPECT_LE(longest_line(plan.out), 100U) << plan.out;

  const Finished done =
      support::run(dry_run({mine}, {"--bench", "simulated-chamber", "--seed", "3"}));
  ASSERT_EQ(done.status, 0) << done.err << done.out;
  auto points = measured();
  for (const char* ramp : {"cycle/up", "cycle/down"})
    EXPECT_EQ(points[ramp].size(), 3U * 30) << ramp;
  for (const double temperature_c : points["cycle/high"]) EXPECT_NEAR(temperature_c, 55.0, 2.5);
  for (const double temperature_c : points["cycle/low"]) EXPECT_NEAR(temperature_c, 25.0, 2.5);
  for (const char* end : {"cycle/high", "cycle/low"}) EXPECT_EQ(points[end].size(), 3U * 10) << end;
  for (const char* branch : {"coil_x/up", "coil_x/down", "coil_x/return"}) {
    ASSERT_FALSE(points[branch].empty()) << branch;
    for (const double temperature_c : points[branch]) EXPECT_NEAR(temperature_c, 50.0, 0.3);
  }
  const auto shown = json({"show", "1", "--store", store(), "--json"});
  EXPECT_TRUE(shown["events"].empty()) << shown["events"].dump(2);
  EXPECT_EQ(shown["points"], 245);
  EXPECT_EQ(shown["sensor_lag_s"], 10.0);
}

// With the sensors' lag stated, temperatures of a fast ramp are what the gyro feels: a gyro that
// hides nothing is found to hide nothing.
TEST_F(OwnProcedureTest, AGyroThatHidesNothingIsFoundSoOnFastRampsOfSensorsThatLag) {
  const Finished done = support::run(
      dry_run({"temperature-cycles"}, {"--bench", "simulated-chamber", "--seed", "5"}));
  ASSERT_EQ(done.status, 0) << done.err;
  const auto verdict = json({"diagnose", "1", "--store", store(), "--segment", "cycle/*", "--model",
                             "thermal", "--json"});
  EXPECT_EQ(verdict["verdict"], "adequate") << verdict["missing"].dump(2);
}

TEST_F(OwnProcedureTest, AWaitOfNWindowsIsNPointsAndThePlanSaysSo) {
  const std::string stairs = write("stairs.json", R"({"name": "stairs", "steps": [
    {"step": "for_each", "variable": "level_c", "in": {"from": 24, "to": 34, "step": 2}, "steps": [
      {"step": "set_temperature", "mode": "normal", "target_c": "$level_c"},
      {"step": "wait", "duration_s": 30, "segment": "stairs", "window_s": 30}]},
    {"step": "wait", "duration_s": 120, "segment": "rest", "window_s": 40}]})");
  const Finished plan = fogbench({"plan", stairs});
  EXPECT_EQ(plan.status, 0) << plan.err;
  EXPECT_NE(plan.out.find("9 points"), std::string::npos) << plan.out;
  EXPECT_NE(plan.out.find("level_c 34: stairs"), std::string::npos) << plan.out;
  const Finished steps = fogbench({"plan", stairs, "--steps"});
  EXPECT_NE(steps.out.find("wait for 2 min, recording averages of 40 s as rest: 3 points"),
            std::string::npos)
      << steps.out;
  const Finished done = support::run(dry_run({stairs}, {"--seed", "3"}));
  ASSERT_EQ(done.status, 0) << done.err;
  auto points = measured();
  EXPECT_EQ(points["stairs"].size(), 6U);
  EXPECT_EQ(points["rest"].size(), 3U);
}

TEST_F(OwnProcedureTest, EverythingThatIsWrongIsSaidAtOnce) {
  const std::string wrong = write("wrong.json", R"({"name": "wrong", "steps": [
    {"step": "ramp", "to_c": 31},
    {"step": "waite", "duration_s": 5},
    {"step": "average", "duration": 60}]})");
  const Finished checked = fogbench({"procedure", "check", wrong});
  EXPECT_EQ(checked.status, 3);
  EXPECT_EQ(checked.out, "");
  for (const char* place :
       {"/steps/0: has no key \"rate_c_per_h\"", "/steps/1/step", "/steps/2/duration"}) {
    EXPECT_NE(checked.err.find(place), std::string::npos) << checked.err;
  }
  const std::string impossible = write("impossible.json", R"({"name": "impossible", "steps": [
    {"step": "set_temperature", "mode": "normal", "target_c": 20},
    {"step": "sweep", "axis": "x", "levels_ut": [0, 400], "segment": "coil_x"},
    {"step": "wait", "duration_s": "$absent_s"}]})");
  const Finished refused = fogbench({"procedure", "check", impossible, "--json"});
  EXPECT_EQ(refused.status, 3);
  const auto document = nlohmann::json::parse(refused.out);
  EXPECT_EQ(document["problems"].size(), 4U) << document.dump(2);
}

TEST_F(OwnProcedureTest, AcceptanceTakesTheLevelsOfASmallerBench) {
  const auto plan = json({"plan", "acceptance", "--set", "levels_ut=0,200,0,-200,0", "--json"});
  EXPECT_NE(plan["limits_met"].dump().find("levels -200 to 200 uT"), std::string::npos);
  expect_refused(fogbench({"plan", "acceptance", "--set", "levles_ut=0"}), 3,
                 "(known: average_s, cooling_c, levels_ut, set_points_c, "
                 "tolerance_ut, warm_up_s)");
}

}  // namespace
}  // namespace fogbench::system_tests
