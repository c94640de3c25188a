// Only a real process can be killed: that no moment loses a printed point or breaks the run log,
// and that a signal, a full disk or an unwritable store end in one line and the safe state.

#include <fcntl.h>
#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <deque>
#include <functional>
#include <random>
#include <sstream>
#include <thread>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

using namespace std::chrono_literals;

/// Lines "  12   299.0  coil_x/up ..." of a dry run's output that are whole.
std::vector<std::pair<std::size_t, std::string>> printed_points(const std::string& out) {
  std::vector<std::pair<std::size_t, std::string>> points;
  std::istringstream lines(out.substr(0, out.rfind('\n') + 1));
  bool table = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("point") != std::string::npos && line.find("segment") != std::string::npos) {
      table = true;
      continue;
    }
    std::istringstream words(line);
    std::size_t number = 0;
    std::string time;
    if (!table || !(words >> number >> time)) {
      if (table && !points.empty()) break;
      continue;
    }
    points.emplace_back(number, time);
  }
  return points;
}

TEST_F(FogbenchTest, KilledAtAnyMomentItLosesNoPrintedPoint) {
  // Short averages make many commits. How long a run lasts depends on the machine and its disk.
  const std::vector<std::string> procedure{"coil-sweep", "--set", "average_s=5"};
  const auto started = std::chrono::steady_clock::now();
  ASSERT_EQ(support::run(dry_run(procedure, {"--seed", "40"})).status, 0);
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - started;
  std::mt19937 random(20260101);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  std::size_t killed = 0, with_points = 0, runs_before = 1;
  for (int i = 0; i < 40; ++i) {
    Process process(dry_run(procedure, {"--seed", std::to_string(i)}));
    std::this_thread::sleep_for(part(random) * whole);
    process.signal(SIGKILL);
    const Finished done = process.wait();
    if (done.signal == SIGKILL) ++killed;
    if (!std::filesystem::exists(store())) continue;  // killed before it was made

    const auto listed = json({"runs", "--store", store(), "--json"});
    ASSERT_TRUE(listed.is_object());
    const std::size_t runs = listed["runs"].size();
    ASSERT_GE(runs, runs_before);
    const auto printed = printed_points(done.out);
    if (runs == runs_before) {
      ASSERT_TRUE(printed.empty()) << done.out;
      continue;
    }
    runs_before = runs;
    const std::string run = std::to_string(runs);
    if (done.signal == SIGKILL && done.out.find("Run ") == std::string::npos) {
      const std::string outcome = listed["runs"].back()["outcome"];
      EXPECT_TRUE(outcome == "interrupted" || outcome == "completed") << outcome;
    }
    const auto measured = json({"show", run, "--store", store(), "--json"})["measured"];
    ASSERT_GE(measured.size(), printed.size());
    for (const auto& [number, time] : printed) {
      ASSERT_GE(measured.size(), number);
      char text[32];
      std::snprintf(text, sizeof text, "%.1f", measured[number - 1]["time_s"].get<double>());
      EXPECT_EQ(text, time);
    }
    EXPECT_EQ(fogbench({"show", run, "--store", store()}).status, 0);
    if (!measured.empty()) {
      ++with_points;
      const Finished csv = fogbench({"export", run, "--store", store(), "--unfinished"});
      EXPECT_EQ(csv.status, 0) << csv.err;
      EXPECT_EQ(std::count(csv.out.begin(), csv.out.end(), '\n'),
                static_cast<std::ptrdiff_t>(measured.size()) + 1);
      const Finished raw = fogbench({"export", run, "--store", store(), "--unfinished", "--raw"});
      EXPECT_EQ(raw.status, 0) << raw.err;
    }
  }
  // The delays must have hit the middle of runs for this to have tried anything.
  EXPECT_GE(killed, 20U);
  EXPECT_GE(with_points, 5U);
}

TEST_F(FogbenchTest, ASignalAbortsToTheSafeStateAndTheRecordSaysSo) {
  const std::array signals{SIGTERM, SIGINT, SIGHUP};
  std::deque<Process> processes;  // at once: each of them begins in real time
  for (std::size_t i = 0; i < signals.size(); ++i) {
    processes.emplace_back(
        dry_run({"static-record", "--set", "average_s=1"}, {"--speed", "realtime"}));
  }
  for (std::size_t i = 0; i < signals.size(); ++i) {
    ASSERT_TRUE(processes[i].wait_for_output("static ", 60s));
    processes[i].signal(signals[i]);
    const Finished done = processes[i].wait(30s);
    EXPECT_EQ(done.status, 4);
    EXPECT_NE(done.err.find("aborted"), std::string::npos) << done.err;
    EXPECT_NE(done.err.find("in its safe state"), std::string::npos) << done.err;
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 2) << done.err;
  }
  const auto runs = json({"runs", "--store", store(), "--json"})["runs"];
  ASSERT_EQ(runs.size(), signals.size());
  for (const auto& run : runs) {
    EXPECT_EQ(run["outcome"], "aborted");
    const auto shown = json({"show", run["run"].dump(), "--store", store(), "--json"});
    EXPECT_EQ(shown["safe_state_reached"], true);
  }
  expect_refused(fogbench({"export", "1", "--store", store()}), 3, "--unfinished");
}

TEST_F(FogbenchTest, TheDaemonAbortsOnASignalToo) {
  Process process(command({"--bench", "simulated", "--store", store(), "coil-sweep"}, "fogbenchd"));
  // The daemon prints nothing on stdout: wait for its first run in the store.
  for (int i = 0; i < 300; ++i) {
    const Finished listed = fogbench({"runs", "--store", store(), "--json"});
    if (listed.status == 0 && !nlohmann::json::parse(listed.out)["runs"].empty()) break;
    std::this_thread::sleep_for(100ms);
  }
  process.signal(SIGTERM);
  const Finished done = process.wait(30s);
  EXPECT_EQ(done.status, 4) << done.err;
  EXPECT_EQ(json({"runs", "--store", store(), "--json"})["runs"][0]["outcome"], "aborted");
}

TEST_F(FogbenchTest, OutputThatNobodyCanReadAbortsToTheSafeState) {
  const auto to_a_full_disk = [] { dup2(open("/dev/full", O_WRONLY), STDOUT_FILENO); };
  const auto to_a_closed_pipe = [] {
    int ends[2];
    if (pipe(ends) != 0) _exit(126);
    close(ends[0]);
    dup2(ends[1], STDOUT_FILENO);
  };
  for (const std::function<void()>& output :
       {std::function<void()>(to_a_full_disk), std::function<void()>(to_a_closed_pipe)}) {
    const Finished done = support::run(dry_run(kQuickSweep), {{}, output});
    expect_refused(done, 4, "could not be written to standard output");
    const auto runs = json({"runs", "--store", store(), "--json"})["runs"];
    EXPECT_EQ(runs.back()["outcome"], "aborted");
    const auto shown = json({"show", runs.back()["run"].dump(), "--store", store(), "--json"});
    EXPECT_EQ(shown["safe_state_reached"], true);
    EXPECT_EQ(shown["measured"].size(), 1U);
  }
}

TEST_F(FogbenchTest, AFullDiskIsOneLineAndTheStoreStaysReadable) {
  ASSERT_EQ(support::run(dry_run(kQuickSweep)).status, 0);
  // A file-size limit fails writes as a full disk does, for this process only.
  const Process::Setup setup{{}, [] {
                               std::signal(SIGXFSZ, SIG_IGN);
                               const rlimit limit{600'000, 600'000};
                               setrlimit(RLIMIT_FSIZE, &limit);
                             }};
  const Finished done =
      support::run(dry_run({"coil-sweep", "--set", "average_s=60"}, {"--json"}), setup);
  expect_refused(done, 4, store());
  EXPECT_NE(done.err.find("safe state"), std::string::npos) << done.err;
  EXPECT_EQ(json({"runs", "--store", store(), "--json"})["runs"][0]["outcome"], "completed");
}

TEST_F(FogbenchTest, AStoreThatMayNotBeWrittenIsOneLine) {
  ASSERT_EQ(support::run(dry_run(kQuickSweep)).status, 0);
  namespace fs = std::filesystem;
  fs::permissions(store(), fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
  fs::permissions(folder_.path(), fs::perms(0555));
  // Root may write everywhere: give that up, and stay able to run a program in root's home.
  const Process::Setup setup{
      {}, [] {
        if (geteuid() == 0 && prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, 0, 0, 0) != 0) {
          _exit(126);
        }
      }};
  expect_refused(support::run(dry_run(kQuickSweep), setup), 4, store());
  // Reading needs no permission to write.
  const Finished listed = fogbench({"runs", "--store", store()}, setup);
  EXPECT_EQ(listed.status, 0) << listed.err;
  fs::permissions(folder_.path(), fs::perms(0755));
}

}  // namespace
}  // namespace fogbench::system_tests
