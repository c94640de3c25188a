// What a served bench survives: the death of its daemon, a full disk, a store that is moved away, a
// thousand clients.

#include <sys/resource.h>

#include <chrono>
#include <csignal>
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
  /// The windows of a run's points, each after the one before.
  std::size_t points_in_order(const std::string& run) const {
    const Finished csv = fogbench({"export", run, "--store", store()});
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
  EXPECT_NE(fogbench({"resume", "1"}).out.find("Job 2 takes up run 1, gyro FOG-42:"),
            std::string::npos);
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  EXPECT_TRUE(status()["interrupted"].is_null());
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
  EXPECT_EQ(points_in_order("1"), 40U);
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
