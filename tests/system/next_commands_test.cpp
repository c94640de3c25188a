// What a command proposes next is pasted into a shell as it was printed, and succeeds: in a folder
// whose name has a blank, as people's have.

#include <unistd.h>

#include <filesystem>
#include <sstream>

#include "tests/system/control_fixture.hpp"

namespace fogbench::system_tests {
namespace {

class NextCommandsTest : public ControlTest {
 protected:
  NextCommandsTest() {
    std::filesystem::create_directory(place_);
    const std::string path = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe)
    setenv("PATH", (tests::build_tree().string() + ":" + path).c_str(), 1);
  }

  std::string here(const std::string& name) const { return (place_ / name).string(); }
  Finished shell(const std::string& command) const {
    return support::run({"/bin/sh", "-c", command}, {{}, [this] {
                                                       if (chdir(place_.c_str()) != 0) _exit(126);
                                                     }});
  }
  /// The commands behind "Next: ", and those that follow in its column.
  static std::vector<std::string> proposed(const std::string& out) {
    std::vector<std::string> commands;
    std::istringstream lines(out);
    bool within = false;
    for (std::string line; std::getline(lines, line);) {
      const bool first = line.rfind("Next: ", 0) == 0;
      within = first || (within && line.rfind("      ", 0) == 0);
      if (within) commands.push_back(line.substr(6));
    }
    return commands;
  }
  /// Runs what is proposed, and what that proposes in turn, a few generations long.
  void follow(const std::string& out, int generations, std::size_t& tried) {
    const auto commands = proposed(out);
    for (const std::string& command : commands) {
      ++tried;
      const Finished done = shell(command);
      // A sweep alone does not show all that the limits ask for: no pass.
      const bool judges = command.rfind("fogbench verdict ", 0) == 0;
      EXPECT_EQ(done.status, judges ? 1 : 0) << command << "\n" << done.err;
      if (generations > 1) follow(done.out, generations - 1, tried);
    }
  }

  std::filesystem::path place_ = folder_ / "two words";
};

TEST_F(NextCommandsTest, OfADryRunSucceedAndSoDoTheirs) {
  for (const std::vector<std::string>& procedure :
       {kQuickSweep, {"static-record", "--set", "duration_s=600"}}) {
    std::vector<std::string> arguments{"dry-run", "--seed", "3", "--store", here("run log.db")};
    arguments.insert(arguments.end(), procedure.begin(), procedure.end());
    const Finished done = fogbench(arguments);
    ASSERT_EQ(done.status, 0) << done.err;
    std::size_t tried = 0;
    follow(done.out, 3, tried);
    EXPECT_GE(tried, 3U) << done.out;
  }
}

TEST_F(NextCommandsTest, OfARunThatMeasuredNothingOnlyShowIt) {
  const Finished done = fogbench({"dry-run", "--seed", "3", "--store", here("run log.db"),
                                  "static-record", "--set", "duration_s=30"});
  EXPECT_EQ(done.status, 4);
  EXPECT_NE(done.err.find("nothing was measured"), std::string::npos) << done.err;
  EXPECT_EQ(proposed(done.out).size(), 1U) << done.out;
  std::size_t tried = 0;
  follow(done.out, 1, tried);
  EXPECT_EQ(json({"show", "1", "--store", here("run log.db"), "--json"})["outcome"], "failed");
}

TEST_F(NextCommandsTest, OfAModelsCommandsSucceed) {
  const std::string thermal = (tests::source_tree() / "config/data/paper-thermal.csv").string();
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"compare", thermal, "--model", "paper-thermal"},
        {"compare", thermal, "--model", "paper-thermal", "--as-is"},
        {"fit", thermal, "--model", "paper-thermal", "-o", here("it's fitted.json")}}) {
    const Finished done = fogbench(command);
    ASSERT_EQ(done.status, 0) << done.err;
    std::size_t tried = 0;
    follow(done.out, 2, tried);
    EXPECT_GE(tried, 1U) << done.out;
  }
}

TEST_F(NextCommandsTest, OfOrdersToADaemonSucceed) {
  const auto daemon = serve();
  for (const std::string gyro : {"A", "A", "B"}) {
    const Finished queued =
        fogbench({"run", procedure("short", 1), "--gyro", gyro, "--socket", socket()});
    ASSERT_EQ(queued.status, 0) << queued.err;
    std::size_t tried = 0;
    follow(queued.out, 1, tried);
    EXPECT_EQ(tried, 1U) << queued.out;
    EXPECT_EQ(fogbench({"watch"}).status, 0);
  }
  EXPECT_EQ(json({"runs", "--store", store(), "--json"})["runs"].size(), 3U);
}

}  // namespace
}  // namespace fogbench::system_tests
