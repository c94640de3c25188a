// What a served bench survives: the death of its daemon, a full disk, a store that is moved away,
// no file handles, a thousand clients, the machine's zone.

#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <ctime>
#include <thread>

#include "tests/support/polling_clients.hpp"
#include "tests/system/control_fixture.hpp"

namespace fogbench::system_tests {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class RecoveryTest : public ControlTest {
 protected:
  static nlohmann::json wait_for_points(int least) {
    return wait_until([least](const nlohmann::json& now) {
      return now["run"].is_object() && now["run"]["points"] >= least;
    });
  }
  /// Of its `stat` in /proc: what it has computed since it began.
  static double cpu_of_thread_s(const std::string& thread) {
    const std::string stat = support::read_text(thread + "/stat");
    unsigned long user = 0, system = 0;
    EXPECT_EQ(std::sscanf(stat.c_str() + stat.rfind(')'),
                          ") %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu", &user, &system),
              2)
        << stat;
    return static_cast<double>(user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  }
  /// The windows of a run's points, each after the one before.
  std::size_t points_in_order(const std::string& run) const {
    const Finished csv = fogbench({"export", run, "--unfinished", "--store", store()});
    EXPECT_EQ(csv.status, 0) << csv.err;
    std::istringstream lines(csv.out);
    std::string line;
    std::getline(lines, line);
    double end_s = 0.0;
    std::size_t count = 0;
    while (std::getline(lines, line)) {
      double time_s = 0.0, duration_s = 0.0;
      EXPECT_EQ(std::sscanf(line.c_str(), "1,a,average,%lf,%lf", &time_s, &duration_s), 2) << line;
      EXPECT_GE(time_s - duration_s / 2.0 + 1e-6, end_s) << line;
      end_s = time_s + duration_s / 2.0;
      ++count;
    }
    return count;
  }
};

TEST_F(RecoveryTest, AfterTheDeathOfTheDaemonARunIsTakenUpAndTheQueueIsThere) {
  auto daemon = serve();
  json({"run", procedure("long", 40), "--gyro", "FOG-42", "--json"});
  json({"run", procedure("next", 1), "--gyro", "FOG-43", "--json"});
  wait_for_points(5);
  EXPECT_NE(fogbench({"status"}).out.find("run 1, long, gyro FOG-42, asked"), std::string::npos);
  daemon->signal(SIGKILL);
  EXPECT_EQ(daemon->wait(30s).signal, SIGKILL);

  daemon = serve();
  const auto back = status();
  EXPECT_EQ(back["state"], "idle") << "nothing begins by itself";
  EXPECT_EQ(back["interrupted"]["run"], 1);
  EXPECT_EQ(back["interrupted"]["gyro"], "FOG-42");
  EXPECT_GE(back["interrupted"]["points"], 5);
  EXPECT_EQ(back["queue"]["jobs"], 1);
  EXPECT_EQ(back["queue"]["held"], true);
  EXPECT_NE(fogbench({"queue"}).out.find("FOG-43"), std::string::npos);
  EXPECT_NE(fogbench({"status"}).out.find("fogbench resume 1"), std::string::npos);

  expect_refused(fogbench({"resume", "7"}), 3, "no run 7");
  EXPECT_NE(fogbench({"resume", "1"}).out.find("Job 3 takes up run 1, gyro FOG-42:"),
            std::string::npos);
  const Finished taken_up = fogbench({"watch"});
  EXPECT_EQ(taken_up.status, 0);
  EXPECT_NE(taken_up.out.find("held: the last run was for gyro FOG-42, the next needs gyro FOG-43"),
            std::string::npos)
      << taken_up.out;
  EXPECT_TRUE(status()["interrupted"].is_null());
  EXPECT_EQ(fogbench({"resume"}).status, 0);
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  const auto runs = json({"runs", "--store", store(), "--json"})["runs"];
  ASSERT_EQ(runs.size(), 3U);
  EXPECT_EQ(runs[0]["outcome"], "interrupted");
  EXPECT_EQ(runs[1]["outcome"], "completed");
  EXPECT_EQ(runs[2]["procedure"], "next") << "what waited goes on after it";
  for (const auto& [run, gyro] :
       {std::pair{"1", "FOG-42"}, std::pair{"2", "FOG-42"}, std::pair{"3", "FOG-43"}}) {
    EXPECT_EQ(runs[std::stoul(run) - 1]["gyro_serial_number"], gyro) << "the daemon names none";
    const auto record = stored(run);
    EXPECT_EQ(record["gyro_serial_number"], gyro);
    for (const auto& instrument : record["instruments"]) {
      EXPECT_EQ(instrument["serial_number"] == gyro, instrument["role"] == "gyro") << instrument;
    }
  }
  EXPECT_EQ(points_in_order("2"), 40U);
  EXPECT_TRUE(has_event(stored("2"), "takes up run 1 at step "));
  expect_refused(fogbench({"resume", "1"}), 3, "run 2 did already");
  expect_refused(fogbench({"resume", "2"}), 3, "it was completed");
}

TEST_F(RecoveryTest, AnInterruptedRunCanBeGivenUp) {
  auto daemon = serve();
  json({"run", procedure("long", 40), "--json"});
  wait_for_points(2);
  daemon->signal(SIGKILL);
  daemon->wait(30s);
  daemon = serve();
  EXPECT_EQ(fogbench({"resume", "1", "--discard"}).status, 0);
  expect_refused(fogbench({"resume", "1", "--discard"}), 4, "does not wait to be taken up");
  EXPECT_TRUE(status()["interrupted"].is_null());
  daemon->signal(SIGTERM);
  daemon->wait(30s);
  daemon = serve();
  EXPECT_TRUE(status()["interrupted"].is_null()) << "nor is it offered again";
}

TEST_F(RecoveryTest, AFullDiskHoldsTheRunUntilThereIsRoom) {
  auto daemon = serve();
  json({"run", procedure("long", 40), "--json"});
  wait_for_points(3);
  const auto limit_files = [&](rlim_t bytes) {
    rlimit limit{};
    ASSERT_EQ(prlimit(daemon->id(), RLIMIT_FSIZE, nullptr, &limit), 0);
    limit.rlim_cur = bytes;
    ASSERT_EQ(prlimit(daemon->id(), RLIMIT_FSIZE, &limit, nullptr), 0);
  };
  limit_files(fs::file_size(store() + "-wal"));
  const auto waiting = wait_until([](const nlohmann::json& now) {
    return now["run"].is_object() && now["run"]["says"].get<std::string>().find(
                                         "waiting for the run log") != std::string::npos;
  });
  std::this_thread::sleep_for(500ms);
  EXPECT_EQ(status()["run"]["points"], waiting["run"]["points"]);
  limit_files(RLIM_INFINITY);
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  // None is lost. Where the room ends between a point and what else its step writes, the step is
  // measured once more.
  const std::size_t points = points_in_order("1");
  EXPECT_GE(points, 40U);
  EXPECT_LE(points, 41U);
  EXPECT_TRUE(has_event(stored("1"), "nothing was recorded for"));
}

TEST_F(RecoveryTest, AStoreThatIsMovedAwayHoldsTheRunUntilItIsBack) {
  const auto daemon = serve();
  json({"run", procedure("long", 40), "--json"});
  wait_for_points(3);
  const std::string away = store() + ".away";
  fs::rename(store(), away);
  wait_until([](const nlohmann::json& now) {
    return now["run"].is_object() && now["run"]["says"].get<std::string>().find(
                                         "was removed, moved or replaced") != std::string::npos;
  });
  fs::rename(away, store());
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  EXPECT_EQ(points_in_order("1"), 40U);
}

TEST_F(RecoveryTest, EveryDateIsUtcInWhateverZoneTheMachineIs) {
  const auto hour = [](int later_s) {
    const std::time_t then = std::time(nullptr) + later_s;
    std::tm utc{};
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:", gmtime_r(&then, &utc));
    return std::string(text);
  };
  const std::string before = hour(0);
  // Five hours ahead, and one more for daylight saving all the year round.
  const auto daemon = serve({}, {{"TZ=AAA-5BBB,0/0,J365/25"}, {}});
  json({"run", procedure("short", 1), "--json"});
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  const std::string started = stored("1")["started_at"];
  const std::string ended = stored("1")["ended_at"];
  daemon->signal(SIGTERM);
  const std::string log = daemon->wait(30s).err;
  const std::string after = hour(600);  // the bench's calendar runs faster
  for (const std::string& date : {started, ended, log}) {
    EXPECT_TRUE(date.starts_with(before) || date.starts_with(after)) << date;
  }
  EXPECT_EQ(log.substr(23, 2), "Z ") << log;
}

TEST_F(RecoveryTest, WithoutFileHandlesARunGoesOnAndNewClientsWait) {
  const auto daemon = serve();
  json({"run", procedure("long", 40), "--json"});
  wait_for_points(3);
  Process watching(command({"watch"}));
  std::this_thread::sleep_for(300ms);
  const std::string process = "/proc/" + std::to_string(daemon->id());
  rlimit before{};
  ASSERT_EQ(prlimit(daemon->id(), RLIMIT_NOFILE, nullptr, &before), 0);
  rlimit none = before;
  none.rlim_cur = 0;  // the lowest number that is free, so that no other is
  while (fs::exists(fs::symlink_status(process + "/fd/" + std::to_string(none.rlim_cur)))) {
    ++none.rlim_cur;
  }
  ASSERT_EQ(prlimit(daemon->id(), RLIMIT_NOFILE, &none, nullptr), 0);

  const std::size_t points = points_in_order("1");
  Process waiting(command({"status"}));
  const double cpu_s = cpu_of_thread_s(process + "/task/" + std::to_string(daemon->id()));
  std::this_thread::sleep_for(1500ms);
  // The main thread serves the socket. One that does not wait takes a second of these.
  EXPECT_LT(cpu_of_thread_s(process + "/task/" + std::to_string(daemon->id())) - cpu_s, 0.4);
  EXPECT_GT(points_in_order("1"), points) << "the run goes on";
  EXPECT_FALSE(waiting.wait_for_output("long", 0s)) << "nobody has been let in";

  ASSERT_EQ(prlimit(daemon->id(), RLIMIT_NOFILE, &before, nullptr), 0);
  const Finished waited = waiting.wait(30s);
  EXPECT_EQ(waited.status, 0) << waited.err;
  EXPECT_NE(waited.out.find("long"), std::string::npos) << waited.out;
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  EXPECT_EQ(watching.wait(30s).status, 0) << "whoever was there was served all the time";
  EXPECT_EQ(points_in_order("1"), 40U);
  EXPECT_EQ(stored("1")["stream"]["frames_missing"], 0);
}

TEST_F(RecoveryTest, AThousandClientsThatPollDoNotDisturbARun) {
  const auto daemon = serve();
  json({"run", procedure("long", 20), "--json"});
  wait_for_points(1);
  test::PollingClients clients(socket(), 1000);
  EXPECT_EQ(clients.connected(), 1000U);
  clients.poll_for(3s, 500ms);
  EXPECT_GT(clients.answers(), 1000U);
  EXPECT_EQ(fogbench({"watch"}).status, 0) << "an operator gets through";
  const auto run = stored("1");
  EXPECT_EQ(run["outcome"], "completed");
  EXPECT_EQ(run["stream"]["frames_missing"], 0);
  EXPECT_EQ(run["stream"]["frames_repeated"], 0);
  EXPECT_EQ(points_in_order("1"), 20U);
}

}  // namespace
}  // namespace fogbench::system_tests
