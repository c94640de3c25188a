// fogbench diagnose --each: many tables in one call say what each would say by itself.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

class DiagnoseEachTest : public FogbenchTest {
 protected:
  DiagnoseEachTest() {
    write("line.json", R"json({"name": "line", "observable": "rate_deg_per_h",
      "terms": [{"effect": "bias"}, {"effect": "magnetic_linear_z"}]})json");
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  /// A sweep along z; `bent`: with a square of the field hidden.
  std::string table(const std::string& name, bool bent) const {
    std::string text = "time_s,duration_s,field_z_ut,rate_deg_per_h\n";
    std::uint32_t state = 777;
    for (int i = 0; i < 48; ++i) {
      const double field = 200.0 * std::sin(0.3 * i);
      state = state * 1664525u + 1013904223u;
      const double scatter = 0.01 * ((state >> 8) / static_cast<double>(1u << 24) - 0.5);
      text += fmt::format("{},180,{:.3f},{:.6f}\n", 200 * (i + 1), field,
                          0.7 - 0.0025 * field + (bent ? 2e-6 * field * field : 0.0) + scatter);
    }
    return write(name, text);
  }
  std::vector<std::string> each(std::vector<std::string> files,
                                const std::vector<std::string>& more = {}) const {
    std::vector<std::string> out{"diagnose", "--each", "--model", (folder_ / "line.json").string()};
    out.insert(out.end(), files.begin(), files.end());
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }
};

TEST_F(DiagnoseEachTest, SaysOfEachWhatASingleCallSays) {
  const std::string straight = table("a.csv", false), bent = table("b.csv", true);
  const auto all = json(each({straight, bent, straight}, {"--json"}));
  ASSERT_EQ(all.size(), 3U);
  for (const auto& [at, file] : {std::pair{0, straight}, std::pair{1, bent}}) {
    auto single = json({"diagnose", file, "--model", (folder_ / "line.json").string(), "--json"});
    auto of_each = all[static_cast<std::size_t>(at)];
    EXPECT_EQ(of_each["data"], file);
    of_each.erase("data");
    EXPECT_EQ(of_each, single);
  }
  EXPECT_EQ(all[0]["verdict"], "adequate");
  EXPECT_EQ(all[1]["verdict"], "missing_effect");
}

TEST_F(DiagnoseEachTest, OneLineATableAndTheWorstExitStatus) {
  const std::string straight = table("a.csv", false), bent = table("b.csv", true);
  const Finished fine = fogbench(each({straight}, {"--check"}));
  EXPECT_EQ(fine.status, 0) << fine.err;
  const Finished no = fogbench(each({bent, straight}, {"--check"}));
  EXPECT_EQ(no.status, 1);
  EXPECT_EQ(std::count(no.out.begin(), no.out.end(), '\n'), 2);
  EXPECT_EQ(no.out.rfind(bent + ": missing_effect: ", 0), 0U) << no.out;
  const Finished bad = fogbench(each({write("empty.csv", ""), bent}, {"--check"}));
  EXPECT_EQ(bad.status, 3);
  EXPECT_NE(bad.out.find("empty file"), std::string::npos) << bad.out;
  EXPECT_NE(bad.out.find("missing_effect"), std::string::npos) << bad.out;
}

TEST_F(DiagnoseEachTest, OnePageForManyTablesIsRefused) {
  expect_refused(fogbench(each({table("a.csv", false)}, {"--report", "page.html"})), 2, "--each");
}

}  // namespace
}  // namespace fogbench::system_tests
