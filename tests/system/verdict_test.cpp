// From a run to a signed page as an engineer makes them: that the commands agree with each other
// about one run, refuse a run that was not completed, and say so by their exit status.

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

using testing::HasSubstr;

/// Both tests of an acceptance, in a few short averages.
constexpr auto kShortAcceptance = R"({
  "name": "short-acceptance", "description": "Both tests, short.",
  "parameters": {"levels_ut": [0, 150, 300, 150, 0, -150, -300, -150, 0], "set_points_c": [31, 36]},
  "steps": [
    {"step": "wait", "duration_s": 600, "segment": "static", "window_s": 60},
    {"step": "call", "procedure": "CONFIG/coil-sweep.json", "test": 1,
     "parameters": {"average_s": 20, "levels_ut": "$levels_ut"}},
    {"step": "call", "procedure": "CONFIG/thermostat-steps.json", "test": 1,
     "parameters": {"set_points_c": "$set_points_c", "warm_up_s": 0, "dwell_s": 60, "band_c": 0.3,
                    "slope_c_per_h": 5}},
    {"step": "call", "procedure": "CONFIG/coil-sweep.json", "test": 2,
     "parameters": {"average_s": 20, "levels_ut": "$levels_ut"}},
    {"step": "call", "procedure": "CONFIG/thermostat-steps.json", "test": 2,
     "parameters": {"set_points_c": "$set_points_c", "warm_up_s": 0, "dwell_s": 60, "band_c": 0.3,
                    "slope_c_per_h": 5}}
  ]})";

std::string content_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

class VerdictTest : public FogbenchTest {
 protected:
  std::string file(const std::string& name, std::string content) {
    const std::string config = (tests::source_tree() / "config" / "procedures").string();
    for (std::size_t at; (at = content.find("CONFIG")) != std::string::npos;) {
      content.replace(at, 6, config);
    }
    std::ofstream(folder_ / name) << content;
    return (folder_ / name).string();
  }

  std::string limits(const std::string& name, double k_maximum) {
    return file(name,
                R"({"name": "limits", "tests": 2, "limits": [{"quantity": "K_z", "minimum": -)" +
                    std::to_string(k_maximum) + R"(, "maximum": )" + std::to_string(k_maximum) +
                    R"(, "unit": "deg/h per 100 uT"}]})");
  }
};

TEST_F(VerdictTest, OneRunFromMeasurementToPassport) {
  const std::string procedure = file("short.json", kShortAcceptance);
  const Finished run =
      support::run(dry_run({procedure}, {"--scenario", "device-2", "--seed", "3", "--operator",
                                         "Ivanova", "--gyro", "FOG-42"}));
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string wide = limits("wide.json", 5.0), narrow = limits("narrow.json", 0.01);

  const auto passed = json({"verdict", "1", "--limits", wide, "--store", store(), "--json"});
  EXPECT_EQ(passed["verdict"], "pass");
  EXPECT_EQ(passed["gyro_serial_number"], "FOG-42");
  ASSERT_EQ(passed["results"].size(), 2U);
  EXPECT_NEAR(passed["results"][0]["value"].get<double>(), -0.253,
              2.0 * passed["results"][0]["expanded_uncertainty"].get<double>());

  const Finished failed = fogbench({"verdict", "1", "--limits", narrow, "--store", store()});
  EXPECT_EQ(failed.status, 1);
  EXPECT_THAT(failed.out, HasSubstr("fail: gyro FOG-42"));

  const std::string page = (folder_ / "passport.html").string();
  for (const std::string language : {"en", "ru"}) {
    const Finished written = fogbench({"passport", "1", "--limits", wide, "--store", store(), "-o",
                                       page, "--language", language});
    EXPECT_EQ(written.status, 0) << written.err;
    EXPECT_THAT(content_of(page), HasSubstr("<html lang=\"" + language + "\">"));
    EXPECT_THAT(content_of(page), HasSubstr("Ivanova"));
  }

  const auto document = json({"passport", "1", "--limits", wide, "--store", store(), "--json"});
  const auto& origin = document["origin"][0];
  const auto shown = json({"show", "1", "--store", store(), "--json"});
  EXPECT_EQ(origin["raw_sha256"], shown["raw_sha256"]);
  EXPECT_EQ(origin["operator"], "Ivanova");
  EXPECT_EQ(shown["operator"], "Ivanova");
  EXPECT_EQ(origin["seed"], 3);
  EXPECT_EQ(origin["instruments"].size(), 6U);
  for (const auto& instrument : origin["instruments"]) {
    if (instrument["role"] != "gyro") continue;
    EXPECT_EQ(instrument["serial_number"], "FOG-42");
  }
  EXPECT_EQ(document["noise"].size(), 1U);
  EXPECT_EQ(document["tests"].size(), 2U);

  // What the fit of a run says about its data.
  const std::string fitted = (folder_ / "fitted.json").string();
  json({"fit", "1", "--model", "general", "--store", store(), "-o", fitted, "--json"});
  EXPECT_THAT(content_of(fitted), HasSubstr(origin["raw_sha256"].get<std::string>()));
}

TEST_F(VerdictTest, ARunThatWasNotCompletedIsNotJudgedUnasked) {
  const std::string scenario = file("fault.json", R"({"name": "f", "noise": "tactical",
    "faults": [{"device": "gyro", "kind": "unplug", "at_s": 200, "for_s": 3600}]})");
  const Finished run = support::run(
      dry_run({"coil-sweep", "--set", "average_s=20"}, {"--scenario", scenario, "--seed", "1"}));
  ASSERT_EQ(run.status, 4) << run.err;
  const std::string says = "run 1 was not completed (failed); --unfinished takes what it has";
  for (const char* command : {"verdict", "passport", "fit", "compare", "diagnose", "compensate"}) {
    std::vector<std::string> arguments{command, "1", "--store", store()};
    if (command != std::string("verdict")) {
      arguments.insert(arguments.end(), {"-o", (folder_ / "out.html").string()});
    }
    if (command != std::string("verdict") && command != std::string("passport")) {
      arguments.insert(arguments.end(), {"--model", "magnetic"});
    }
    if (command == std::string("compare")) {
      arguments.erase(std::find(arguments.begin(), arguments.end(), "-o"), arguments.end());
      arguments.insert(arguments.end(), {"--model", "magnetic"});
    }
    expect_refused(fogbench(arguments), 3, says);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.html"));
  const Finished asked = fogbench({"verdict", "1", "--unfinished", "--store", store()});
  EXPECT_EQ(asked.status, 1);
  EXPECT_THAT(asked.out, HasSubstr("indeterminate"));
  EXPECT_THAT(asked.out, HasSubstr("Run 1 was not completed (failed)"));
}

TEST_F(VerdictTest, MistakesAreOneLine) {
  expect_refused(fogbench({"verdict", "one", "--store", store()}), 2, "the number of a run");
  expect_refused(fogbench({"verdict", "1", "--store", store()}), 3, "no such run log");
  expect_refused(fogbench({"verdict", "1", "--limits", "nonsense"}), 3, "nonsense");
  expect_refused(fogbench({"passport", "1", "--store", store()}), 2, "-o FILE or --json");
  expect_refused(fogbench({"passport", "1", "-o", "x.html", "--language", "de"}), 2, "--language");
}

}  // namespace
}  // namespace fogbench::system_tests
