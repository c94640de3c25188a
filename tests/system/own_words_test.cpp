// Three tasks of a test engineer, each in the steps that README says and no more: a table of one's
// own, a formula of one's own, and two measurements against each other. And what is said to who
// mistypes.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class OwnWordsTest : public FogbenchTest {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string written(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return path(name);
  }
  void dry_run_of(const std::string& gyro, const std::string& scenario,
                  const std::string& seed) const {
    const Finished done = support::run(
        dry_run(kQuickSweep, {"--gyro", gyro, "--scenario", scenario, "--seed", seed}));
    ASSERT_EQ(done.status, 0) << done.err;
  }
};

/// 0,5 deg/h - 0,02 deg/h/degC (T - 21 degC), as another program writes it: deg/s and kelvin,
/// decimal commas.
std::string foreign_table() {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::string text = "zeit;T (K);gyro [deg/s]\n";
  for (int i = 0; i < 240; ++i) {
    const double celsius = 21.0 + 0.125 * i;
    const double rate = 0.5 - 0.02 * (celsius - 21.0) + 0.01 * normal(random);
    std::string row = fmt::format("{};{:.3f};{:.9f}\n", 60 * i, celsius + 273.15, rate / 3600.0);
    std::replace(row.begin(), row.end(), '.', ',');
    text += row;
  }
  return text;
}

TEST_F(OwnWordsTest, ATableOfAnotherProgramIsFittedInOneStepAndLookedAtInTheNext) {
  const std::string table = written("night.csv", foreign_table());
  const std::vector<std::string> columns{"--column", "rate_deg_per_h=gyro [deg/s]", "--column",
                                         "temperature_c=T (K)"};
  std::vector<std::string> fit{"fit", table};
  fit.insert(fit.end(), columns.begin(), columns.end());
  fit.insert(fit.end(),
             {"--column", "time_s=zeit", "--model", "thermal", "-o", path("night.json")});
  const Finished fitted = fogbench(fit);
  ASSERT_EQ(fitted.status, 0) << fitted.err;
  EXPECT_THAT(fitted.err, AllOf(HasSubstr("decimal commas"), HasSubstr("from T (K) in K")));
  const auto model = nlohmann::json::parse(std::ifstream(path("night.json")));
  const auto linear = std::find_if(model["terms"].begin(), model["terms"].end(), [](const auto& t) {
    return t["effect"] == "temperature_linear";
  });
  ASSERT_NE(linear, model["terms"].end());
  EXPECT_NEAR((*linear)["coefficient"].get<double>(), -0.02, 0.005);
  // What it proposes next is pasted as it stands.
  const std::size_t next = fitted.out.find("Next: fogbench ");
  ASSERT_NE(next, std::string::npos) << fitted.out;
  const std::string command = (tests::build_tree() / "fogbench").string() +
                              fitted.out.substr(next + 14, fitted.out.find('\n', next) - next - 14);
  const Finished looked = support::run({"/bin/sh", "-c", command});
  EXPECT_EQ(looked.status, 0) << command << looked.err;
  EXPECT_THAT(looked.out, HasSubstr("temperature_linear"));
}

/// The model file that a help text shows.
std::string shown_model(const std::string& help) {
  const std::size_t begin = help.find("  {\"name\""), end = help.find("\n  ]}\n");
  EXPECT_NE(begin, std::string::npos) << help;
  EXPECT_NE(end, std::string::npos) << help;
  return help.substr(begin, end + 6 - begin);
}

TEST_F(OwnWordsTest, AFormulaWithAnInnerParameterIsFittedAsHelpShowsIt) {
  const Finished help = fogbench({"help", "expressions"});
  ASSERT_EQ(help.status, 0) << help.err;
  EXPECT_THAT(help.out, AllOf(HasSubstr("tanh"), HasSubstr("log is natural")));
  const std::string model = written("mine.json", shown_model(help.out));
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::string text = "time_s,field_z_ut,rate_deg_per_h\n";
  for (int i = 0; i < 200; ++i) {
    const double field = 300.0 * std::sin(0.1 * i);
    text += fmt::format("{},{:.3f},{:.6f}\n", 60 * i, field,
                        0.7 + 0.2 * std::tanh(field / 120.0) + 0.004 * normal(random));
  }
  const std::string table = written("table.csv", text);
  const auto fitted = json({"fit", table, "--model", model, "-o", path("fitted.json"), "--json"});
  double s = 0.0, expanded = 0.0, amplitude = 0.0;
  for (const auto& e : fitted["estimates"]) {
    if (e["name"] == "my_saturation") amplitude = e["value"];
    if (!e["name"].get<std::string>().ends_with(".s") && e["name"] != "s") continue;
    s = e["value"];
    expanded = e["expanded_uncertainty"];
  }
  EXPECT_NEAR(s, 120.0, 2.0 * expanded) << fitted.dump();
  EXPECT_NEAR(amplitude, 0.2, 0.01) << fitted.dump();
  EXPECT_EQ(
      fogbench({"compensate", table, "--model", path("fitted.json"), "-o", path("out.csv")}).status,
      0);
}

/// What was recognised in the table is said beside a result, and not in front of an error.
TEST_F(OwnWordsTest, ATableOfAnotherProgramThatCannotBeFittedGetsOneLine) {
  const std::string table =
      written("short.csv", "zeit;T (K);gyro [deg/s]\n0;294,15;0,0001\n60;294,25;0,0001\n");
  expect_refused(fogbench({"fit", table, "--model", "thermal", "-o", path("x.json")}), 3, "rows");
}

/// The gyro is described, measured twice, diagnosed on the first run and corrected on the second,
/// which took no part in the fit: what is left there is noise.
TEST_F(OwnWordsTest, TwoHiddenEffectsAreFoundAddedAndTakenOutOfAnotherRun) {
  const std::string scenario = written("two.json", R"({
    "name": "two", "description": "A shield that remembers, and a quadratic sensitivity.",
    "noise": "navigation",
    "gyro": {"terms": {"bias": 0.7, "temperature_linear": -0.012, "magnetic_linear_z": -0.25}},
    "hidden": [{"effect": "magnetic_hysteresis_z", "amplitude": 0.12, "width": 0.6},
               {"effect": "magnetic_quadratic_x", "amplitude": 0.02}]})");
  for (const char* seed : {"31", "32"}) {
    const Finished measured = fogbench({"dry-run", "acceptance", "--scenario", scenario, "--gyro",
                                        "FOG-3", "--seed", seed, "--store", store()});
    ASSERT_EQ(measured.status, 0) << measured.err;
  }
  const auto diagnosis =
      json({"diagnose", "1", "--model", "general", "--store", store(), "--json"});
  EXPECT_EQ(diagnosis["verdict"], "missing_effect");
  std::vector<std::string> add{"add"};
  for (const auto& missing : diagnosis["missing"]) {
    add.push_back(missing["effect"].get<std::string>());
  }
  EXPECT_THAT(
      add, testing::UnorderedElementsAre("add", "magnetic_hysteresis_z", "magnetic_quadratic_x"));
  add.insert(add.end(), {"--model", "general", "-o", path("wider.json")});
  ASSERT_EQ(fogbench(add).status, 0);
  ASSERT_EQ(fogbench({"fit", "1", "--model", path("wider.json"), "-o", path("fitted.json"),
                      "--store", store()})
                .status,
            0);
  const auto corrected = json({"compensate", "2", "--model", path("fitted.json"), "-o",
                               path("corrected.csv"), "--store", store(), "--json"});
  EXPECT_GT(corrected["deviation_before"].get<double>(), 0.1);
  // The noise of this gyro leaves 0.009 deg/h within a run, and its bias wanders between two.
  EXPECT_LT(corrected["deviation_after"].get<double>(), 0.02);
}

TEST_F(OwnWordsTest, RunsOfTwoGyrosAreComparedAndNeverMergedUnasked) {
  dry_run_of("FOG-1", "device-1", "1");
  dry_run_of("FOG-1", "device-1", "2");
  dry_run_of("FOG-2", "device-2", "3");
  const std::string fitted = path("fitted.json");
  for (const std::vector<std::string>& merging :
       {std::vector<std::string>{"fit", "1", "3", "--model", "magnetic", "-o", fitted},
        {"diagnose", "1", "3", "--model", "magnetic"},
        {"diagnose", "1", "--quiet", "3", "--model", "magnetic"}}) {
    std::vector<std::string> arguments = merging;
    arguments.insert(arguments.end(), {"--store", store()});
    expect_refused(fogbench(arguments), 3,
                   "run 1 is of gyro FOG-1 and run 3 of gyro FOG-2; fogbench compare 1 3 holds "
                   "them against each other");
  }
  EXPECT_FALSE(std::filesystem::exists(fitted));
  EXPECT_EQ(fogbench({"fit", "1", "3", "--several-gyros", "--model", "magnetic", "-o", fitted,
                      "--store", store()})
                .status,
            0);
  EXPECT_EQ(
      fogbench({"fit", "1", "2", "--model", "magnetic", "-o", fitted, "--store", store()}).status,
      0);

  const auto same = json({"compare", "1", "2", "--store", store(), "--json"});
  EXPECT_EQ(same["same_gyro"], true);
  EXPECT_EQ(same["model"], "magnetic model") << same.dump();
  EXPECT_EQ(same["coefficients"].size(), 4U);
  const auto two = json({"compare", "1", "3", "--store", store(), "--json"});
  EXPECT_EQ(two["same_gyro"], false);
  EXPECT_EQ(two["differs"], true);
  const auto z = std::find_if(two["coefficients"].begin(), two["coefficients"].end(),
                              [](const auto& c) { return c["name"] == "magnetic_linear_z"; });
  ASSERT_NE(z, two["coefficients"].end());
  // -0.252 of the one, -0.05 of the other.
  EXPECT_NEAR((*z)["difference"].get<double>(), -0.2,
              2.0 * (*z)["expanded_uncertainty"].get<double>());

  const Finished text =
      fogbench({"compare", "1", "3", "--store", store(), "--check", "--report", path("page.html")});
  EXPECT_EQ(text.status, 1) << text.err;
  EXPECT_THAT(text.out, HasSubstr("Two gyros: run 1 is of FOG-1, run 3 of FOG-2."));
  std::ostringstream page;
  page << std::ifstream(path("page.html")).rdbuf();
  EXPECT_THAT(page.str(), AllOf(HasSubstr("run 3 against run 1"), HasSubstr("magnetic_linear_z")));
}

TEST_F(OwnWordsTest, TestsOfOneRunAreNamedByItsNumberAndTheirs) {
  const std::string sweep = (tests::source_tree() / "config/procedures/coil-sweep.json").string();
  const std::string call = R"({"step": "call", "procedure": ")" + sweep +
                           R"(", "parameters": {"average_s": 3, "levels_ut": "$levels_ut"}, )";
  const std::string twice =
      written("twice.json",
              R"({"name": "twice", "parameters": {"levels_ut": [0, 300, 0, -300, 0]}, "steps": [)" +
                  call + R"("test": 1}, )" + call + R"("test": 2}]})");
  ASSERT_EQ(support::run(dry_run({twice}, {"--seed", "4", "--gyro", "FOG-7"})).status, 0);
  const auto compared = json({"compare", "1/1", "1/2", "--store", store(), "--json"});
  EXPECT_EQ(compared["data"], nlohmann::json({"test 1 of run 1", "test 2 of run 1"}));
  EXPECT_EQ(compared["same_gyro"], true);
  EXPECT_EQ(compared["coefficients"].size(), 4U);
  const auto first = json({"fit", "1", "--test", "1", "--model", "magnetic", "-o",
                           path("first.json"), "--store", store(), "--json"});
  const auto both = json(
      {"fit", "1", "--model", "magnetic", "-o", path("both.json"), "--store", store(), "--json"});
  EXPECT_EQ(2 * first["rows"].get<int>(), both["rows"].get<int>());
  expect_refused(
      fogbench({"compare", "1", "--test", "3", "--model", "magnetic", "--store", store()}), 3,
      "has no test 3, expected one of 1, 2");
  const Finished exported = fogbench({"export", "1", "--store", store()});
  EXPECT_EQ(exported.out.rfind("test,segment,", 0), 0U) << exported.out.substr(0, 80);
}

TEST_F(OwnWordsTest, AMistypedNameIsAnsweredWithTheNearest) {
  const std::string limits =
      written("limits.json",
              R"({"name": "l", "limits": [{"quantity": "bias", "max": 1, "unit": "deg/h"}]})");
  const std::string formula = written(
      "formula.json",
      R"text({"name": "f", "terms": [{"effect": "m", "expression": "thanh(rate_deg_per_h)"}]})text");
  const std::string table = written("t.csv", "rate_deg_per_h\n1\n2\n3\n");
  struct Mistake {
    std::vector<std::string> arguments;
    int status;
    std::string says;
  };
  const std::vector<Mistake> mistakes{
      {{"diagnos", "7"}, 2, R"(did you mean "diagnose"?)"},
      {{"diagnose", "7", "--modle", "m"}, 2, R"(did you mean "--model"?)"},
      {{"help", "fitt"}, 2, R"(did you mean "fit"?)"},
      {{"dry-run", "acceptence"}, 3, R"(did you mean "acceptance"?)"},
      {{"dry-run", "coil-sweep", "--scenario", "device2"}, 3, R"(did you mean "device-2"?)"},
      {{"plan", "coil-sweep", "--set", "averages=3"}, 3, R"(did you mean "average_s"?)"},
      {{"device", "check", "coil-kepko"}, 3, R"(did you mean "coil-kepco"?)"},
      {{"verdict", "1", "--limits", "aceptance"}, 3, R"(did you mean "acceptance"?)"},
      {{"effects", "bais"}, 3, R"(did you mean "bias"?)"},
      {{"effects", "hysteresis"}, 3, R"("magnetic_hysteresis_y", "magnetic_hysteresis_z")"},
      {{"fit", table, "--model", formula, "-o", path("x.json")},
       3,
       R"(unknown function thanh; did you mean "tanh"?)"},
      {{"compare", table}, 2, "--model is required, or a second DATA"}};
  for (const Mistake& mistake : mistakes) {
    SCOPED_TRACE(mistake.says);
    expect_refused(fogbench(mistake.arguments), mistake.status, mistake.says);
  }
  ASSERT_EQ(support::run(dry_run(kQuickSweep, {"--seed", "1"})).status, 0);
  expect_refused(fogbench({"verdict", "1", "--limits", limits, "--store", store()}), 3,
                 R"(did you mean "maximum"?)");
  const std::string bais =
      written("bais.json",
              R"({"name": "l", "limits": [{"quantity": "bais", "maximum": 1, "unit": "deg/h"}]})");
  const Finished verdict = fogbench({"verdict", "1", "--limits", bais, "--store", store()});
  EXPECT_EQ(verdict.status, 1);
  EXPECT_THAT(verdict.out, HasSubstr("Limits: no result is called bais; the nearest is bias."));
}

TEST_F(OwnWordsTest, APassportIsPrintedOrItsNameRefused) {
  ASSERT_EQ(support::run(dry_run(kQuickSweep, {"--seed", "1", "--gyro", "FOG \"9\" <b>"})).status,
            0);
  const std::string page = path("passport.html"), sheet = path("passport.pdf");
  ASSERT_EQ(fogbench({"passport", "1", "-o", page, "--store", store()}).status, 0);
  std::ostringstream html;
  html << std::ifstream(page).rdbuf();
  EXPECT_THAT(html.str(), AllOf(HasSubstr("counter(page)"), HasSubstr(R"(FOG \22 9\22  \3c b>")"),
                                Not(HasSubstr("<b>"))));
  expect_refused(fogbench({"passport", "1", "-o", path("passport.doc"), "--store", store()}), 3,
                 "expected .html or .pdf");
  const std::string path_before = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe)
  setenv("PATH", folder_.path().c_str(), 1);
  expect_refused(fogbench({"passport", "1", "-o", sheet, "--store", store()}), 3,
                 "apt install chromium");
  // What stands for Chromium here fails: nothing is written.
  const std::string broken = written("chromium", "#!/bin/sh\nexit 1\n");
  std::filesystem::permissions(broken, std::filesystem::perms::owner_all);
  expect_refused(fogbench({"passport", "1", "-o", sheet, "--store", store()}), 4,
                 "did not print the page");
  EXPECT_FALSE(std::filesystem::exists(sheet));
  setenv("PATH", path_before.c_str(), 1);
  const Finished printed = fogbench({"passport", "1", "-o", sheet, "--store", store()});
  ASSERT_EQ(printed.status, 0) << printed.err;
  std::ostringstream bytes;
  bytes << std::ifstream(sheet, std::ios::binary).rdbuf();
  EXPECT_EQ(bytes.str().rfind("%PDF-", 0), 0U);
}

}  // namespace
}  // namespace fogbench::system_tests
