// Whatever is given to the real program: one line, the right exit status, nothing written.

#include <fcntl.h>
#include <unistd.h>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

std::string junk() {
  std::string bytes(4000, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 131 % 251);
  return bytes;
}

TEST_F(FogbenchTest, UsageIsStatusTwo) {
  expect_refused(fogbench({}), 2, "a command is expected");
  expect_refused(fogbench({"fly"}), 2, "fly");
  expect_refused(fogbench({"show"}), 2, "RUN is required");
  expect_refused(fogbench({"show", "seven"}), 2, "seven");
  expect_refused(fogbench({"runs", "--wings"}), 2, "--wings");
  expect_refused(fogbench({"dry-run", "coil-sweep", "--speed", "warp"}), 2, "warp");
  for (const char* seed : {"-1", "", "1.5", "18446744073709551616"}) {
    expect_refused(fogbench({"dry-run", "coil-sweep", "--seed", seed}), 2, "seed");
  }
  for (const char* run : {"0", "-1", "", "9223372036854775808"}) {
    const std::string says = std::string(run) == "0" ? "there is no run 0" : "number of a run";
    expect_refused(fogbench({"show", run}), 2, says);
    expect_refused(fogbench({"export", run}), 2, says);
  }
  expect_refused(fogbench({"plan", "coil-sweep", "--set", "average_s=1", "--set", "average_s=2"}),
                 2, "average_s is set twice");
  for (const char* set :
       {"average_s", "=1", "average_s=", "average_s=x", "average_s=1,,2", "average_s=nan"}) {
    expect_refused(fogbench({"plan", "coil-sweep", "--set", set}), 2, set);
  }
}

TEST_F(FogbenchTest, HelpAndVersionAreStatusZero) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--help"},
                                                    {"--version"},
                                                    {"dry-run", "--help"},
                                                    {"export", "--help"}}) {
    const Finished done = fogbench(arguments);
    EXPECT_EQ(done.status, 0);
    EXPECT_NE(done.out.find("fogbench"), std::string::npos) << arguments.front();
    EXPECT_EQ(done.err, "");
  }
  EXPECT_NE(fogbench({"dry-run", "--help"}).out.find("Examples:"), std::string::npos);
}

TEST_F(FogbenchTest, BadFilesAreStatusThreeAndNothingIsWritten) {
  const std::string broken = folder_.file("broken.json", "{\"name\": ").string();
  const std::string bytes = folder_.file("junk.json", junk()).string();
  const std::string empty = folder_.file("empty.json", "").string();
  const std::string other = folder_.file("other.json", "{\"wings\": 2}").string();
  const std::string here = folder_.path().string();
  for (const std::string& file : {broken, bytes, empty, other, here, std::string("no-such")}) {
    expect_refused(fogbench({"plan", file}), 3, "");
    for (const char* option : {"--bench", "--scenario"}) {
      expect_refused(support::run(dry_run({"coil-sweep", option, file})), 3, "");
    }
    expect_refused(support::run(dry_run({file})), 3, "");
  }
  const std::string hidden =
      folder_.file("hidden.json", R"({"noise": "navigation", "gyro": {"terms": {"biass": 1}}})")
          .string();
  expect_refused(support::run(dry_run({"coil-sweep", "--scenario", hidden})), 3, "biass");
  expect_refused(fogbench({"plan", "no-such"}), 3, "coil-sweep");  // names the ready ones
  expect_refused(fogbench({"plan", "coil-sweep", "--set", "wings=2"}), 3, "wings");
  expect_refused(fogbench({"plan", "coil-sweep", "--set", "levels_ut=0,900"}), 3, "900");
  EXPECT_FALSE(std::filesystem::exists(store()));
}

// Only a real process has a standard output that takes no more.
TEST_F(FogbenchTest, AFullStandardOutputIsOneLine) {
  const support::Process::Setup full{{}, [] { dup2(open("/dev/full", O_WRONLY), STDOUT_FILENO); }};
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"effects"}, {"effects", "--json"}, {"effects", "bias"}}) {
    expect_refused(fogbench(arguments, full), 4, "could not be written");
  }
}

TEST_F(FogbenchTest, BrokenStoresAreOneLine) {
  const std::string bytes = folder_.file("junk.db", junk()).string();
  const std::string empty = folder_.file("empty.db", "").string();
  const std::string text = folder_.file("text.db", "a run log, honestly").string();
  const std::string missing = (folder_ / "missing.db").string();
  for (const std::string& file : {bytes, empty, text, folder_.path().string(), missing}) {
    expect_refused(fogbench({"runs", "--store", file}), 3, file);
    expect_refused(fogbench({"show", "1", "--store", file}), 3, file);
    expect_refused(fogbench({"export", "1", "--store", file}), 3, file);
  }
  for (const std::string& file : {bytes, text}) {  // an empty file becomes a run log
    expect_refused(fogbench({"dry-run", "coil-sweep", "--json", "--store", file}), 3, file);
  }
  expect_refused(
      fogbench({"dry-run", "coil-sweep", "--json", "--store", (folder_ / "no/such.db").string()}),
      4, "no/such.db");
  EXPECT_EQ(support::read_text(bytes), junk());
  EXPECT_EQ(folder_.entries(), 3U);
}

TEST_F(FogbenchTest, AnUnknownRunAndAnUnwritableExportAreOneLineAndLeaveNothing) {
  ASSERT_EQ(support::run(dry_run(kQuickSweep)).status, 0);
  const auto before = folder_.entries();
  expect_refused(fogbench({"show", "9", "--store", store()}), 3, "no run 9");
  expect_refused(fogbench({"export", "9", "--store", store(), "-o", (folder_ / "x").string()}), 3,
                 "no run 9");
  expect_refused(fogbench({"export", "1", "--store", store(), "-o", folder_.path().string()}), 3,
                 "directory");
  expect_refused(
      fogbench({"export", "1", "--store", store(), "-o", (folder_ / "no/such.db").string()}), 3,
      "no/such");
  expect_refused(fogbench({"export", "1", "--store", store(), "-o", "/dev/full"}), 3, "No space");
  EXPECT_EQ(folder_.entries(), before);
}

TEST_F(FogbenchTest, ResultsThatCannotBePrintedAreOneLine) {
  const Process::Setup full{{}, [] { dup2(open("/dev/full", O_WRONLY), STDOUT_FILENO); }};
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"effects", "bias"},
                                                    {"effects", "--json"},
                                                    {"plan", "acceptance"}}) {
    expect_refused(fogbench(arguments, full), 4, "could not be written to standard output");
  }
}

}  // namespace
}  // namespace fogbench::system_tests
