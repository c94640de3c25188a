// fogbench diagnose as a user types it: the JSON that scripts rely on, files that are not what they
// should be, and the command that it proposes next.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

// A formula ends in `)"`, which would end a plain raw string.
constexpr const char* kWave = R"json({"name": "mine", "observable": "rate_deg_per_h", "terms":
  [{"effect": "my_wave", "expression": "sin(field_z_ut / 20)", "unit": "deg/h"}]})json";
constexpr const char* kLine = R"json({"name": "line", "observable": "rate_deg_per_h",
  "terms": [{"effect": "bias"}, {"effect": "magnetic_linear_z"}]})json";

class DiagnoseCommandTest : public FogbenchTest {
 protected:
  DiagnoseCommandTest() {
    write("line.json", kLine);
    write("wave.json", kWave);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
  /// A sweep along z with a wave in the field hidden.
  std::string table(const std::string& name, const std::string& rate = "rate_deg_per_h") const {
    std::string text = "time_s,duration_s,field_z_ut," + rate + "\n";
    std::uint32_t state = 12345;
    for (int i = 0; i < 48; ++i) {
      const double phase = 8.0 * i / 48;
      const double field = 150.0 * (phase < 2 ? phase : phase < 6 ? 4 - phase : phase - 8);
      state = state * 1664525u + 1013904223u;
      const double scatter = 0.01 * ((state >> 8) / static_cast<double>(1u << 24) - 0.5);
      text += fmt::format("{},180,{},{:.6f}\n", 200 * (i + 1), field,
                          0.7 - 0.0025 * field + 0.1 * std::sin(field / 20) + scatter);
    }
    return write(name, text);
  }
  std::vector<std::string> diagnose(const std::string& data,
                                    const std::vector<std::string>& more = {}) const {
    std::vector<std::string> out{"diagnose", data, "--model", path("line.json")};
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }
};

TEST_F(DiagnoseCommandTest, JsonHasTheKeysThatScriptsRelyOn) {
  const auto document =
      json(diagnose(table("t.csv"), {"--candidate", path("wave.json"), "--json"}));
  std::set<std::string> keys;
  for (const auto& [key, value] : document.items()) keys.insert(key);
  EXPECT_EQ(keys,
            (std::set<std::string>{
                "verdict", "p_adequate", "false_alarm_rate", "fit", "noise", "failures", "missing",
                "ambiguous", "unexplained", "not_testable", "bounds", "next_measurements", "ladder",
                "read_as", "left_out", "noise_source", "sentences", "warnings", "next"}));
  ASSERT_FALSE(document["missing"].empty());
  const auto& found = document["missing"][0];
  EXPECT_EQ(found["effect"], "my_wave");
  EXPECT_NEAR(found["coefficients"]["my_wave"], 0.1, 0.01);
  for (const char* key : {"probability", "p_value", "rms_after", "heldout_rms_after"}) {
    EXPECT_TRUE(found.at(key).is_number()) << key;
  }
}

TEST_F(DiagnoseCommandTest, SameBytesOnOneProcessorAndUnderOtherNames) {
  const auto arguments = diagnose(table("t.csv"), {"--json"});
  const Finished one = fogbench(arguments);
  std::vector<std::string> pinned{"/usr/bin/taskset", "-c", "0"};
  for (const std::string& word : command(arguments)) pinned.push_back(word);
  EXPECT_EQ(support::run(pinned).out, one.out);
  const auto renamed =
      json(diagnose(table("u.csv", "omega"), {"--column", "rate_deg_per_h=omega", "--json"}));
  const auto plain = nlohmann::json::parse(one.out);
  EXPECT_EQ(renamed["sentences"], plain["sentences"]);
  EXPECT_EQ(renamed["missing"], plain["missing"]);
  EXPECT_NE(renamed["next"].get<std::string>().find("--column rate_deg_per_h=omega"),
            std::string::npos);
}

TEST_F(DiagnoseCommandTest, ProposedCommandWorksAsItStands) {
  const auto document =
      json(diagnose(table("my table.csv"), {"--candidate", path("wave.json"), "--json"}));
  const std::string program_folder =
      std::filesystem::path(command({}).front()).parent_path().string();
  const std::string next = document["next"];
  EXPECT_NE(next.find("-o wider.json"), std::string::npos) << next;
  const Finished done =
      support::run({"/bin/sh", "-c",
                    fmt::format("cd {} && PATH='{}':$PATH && {}", path(""), program_folder, next)});
  EXPECT_EQ(done.status, 0) << next << "\n" << done.err;
  EXPECT_TRUE(std::filesystem::exists(path("wider.json")));
  const auto again =
      json({"diagnose", path("my table.csv"), "--model", path("wider.json"), "--json"});
  EXPECT_EQ(again["verdict"], "adequate");
}

TEST_F(DiagnoseCommandTest, BadFilesGetOneLine) {
  const std::string good = table("t.csv");
  const std::string extended = path("extended.json");
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& says) {
    expect_refused(fogbench(arguments), 3, says);
    EXPECT_FALSE(std::filesystem::exists(extended)) << says;
  };
  refused(diagnose(write("empty.csv", ""), {"-o", extended}), "empty file");
  refused(diagnose(write("header.csv", "rate_deg_per_h,field_z_ut\n"), {"-o", extended}),
          "header and no rows");
  refused(diagnose(good, {"-o", extended, "--candidate", write("bad.json", "{")}), "bad.json");
  const std::string unknown = write("unknown.json", R"({"name": "x",
    "observable": "rate_deg_per_h", "terms": [{"effect": "m", "expression": "sin(", "unit": "1"}]})");
  refused(diagnose(good, {"-o", extended, "--candidate", unknown}), "sin(");
  refused(diagnose(good, {"-o", extended, "--quiet", write("q.csv", "humidity\n1\n2\n")}),
          "static record: column rate_deg_per_h");
  refused(diagnose(good, {"-o", path("no/such/folder.json")}), "no/such");
}

TEST_F(DiagnoseCommandTest, PublishedSixPointsAreTooFewAndSaidToBe) {
  const Finished done =
      fogbench({"diagnose", (tests::source_tree() / "config/data/paper-thermal.csv").string(),
                "--model", "paper-thermal"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(done.out.rfind("Cannot tell whether anything is missing: 6 rows", 0), 0U) << done.out;
  EXPECT_NE(done.out.find("  the table has no field_x_ut: magnetic_hysteresis_x, "),
            std::string::npos)
      << done.out;
}

}  // namespace
}  // namespace fogbench::system_tests
