// What operators ask of a queue and of a run log, by hand and across ends of the daemon. Only real
// processes die, have users, and keep a store of their own.

#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>

#include "tests/system/control_fixture.hpp"

namespace fogbench::system_tests {
namespace {

using namespace std::chrono_literals;

class OperatorsTest : public ControlTest {
 protected:
  static std::string queue_text() { return fogbench({"queue"}).out; }
  static nlohmann::json wait_for_end() {
    return wait_until([](const nlohmann::json& now) {
      return now["run"].is_null() && now["last_run"].is_object();
    });
  }
  void run(const std::string& file, const std::string& gyro = "A") const {
    const Finished queued = fogbench({"run", file, "--gyro", gyro});
    ASSERT_EQ(queued.status, 0) << queued.err;
  }
  static void expect_says(const std::string& text, const std::string& says) {
    EXPECT_NE(text.find(says), std::string::npos) << text;
  }
};

TEST_F(OperatorsTest, APauseInTheLastStepHoldsTheQueueAndSaysSo) {
  const auto daemon = serve();
  const std::string last_asks = folder_
                                    .file("asks.json", R"({"name": "asks", "steps": [
             {"step": "average", "duration_s": 1, "segment": "a"},
             {"step": "prompt", "text": "Done?"}]})")
                                    .string();
  run(last_asks);
  run(procedure("next", 1));
  wait_for_prompt();
  const Finished paused = fogbench({"pause"});
  EXPECT_EQ(paused.status, 0) << paused.err;
  expect_says(paused.out, "No step is left to hold before");
  expect_says(fogbench({"status"}).out, "the queue is held after the run");
  ASSERT_EQ(fogbench({"answer", "yes"}).status, 0);
  EXPECT_EQ(wait_for_end()["last_run"]["outcome"], "completed");
  expect_says(queue_text(), "paused run 1, which ended first");
  ASSERT_EQ(fogbench({"resume"}).status, 0);
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  EXPECT_EQ(stored("2")["outcome"], "completed");
}

TEST_F(OperatorsTest, AfterThisRunNoOtherThoughTheDaemonDies) {
  auto daemon = serve();
  run(procedure("asks", 1, "Ready?"));
  run(procedure("second", 1));
  run(procedure("third", 1));
  wait_for_prompt();
  EXPECT_EQ(json({"pause", "--after-run", "--json"}), nlohmann::json({{"pauses", "after_run"}}));
  EXPECT_EQ(fogbench({"queue", "--move", "3", "--to", "1"}).status, 0);
  ASSERT_EQ(fogbench({"answer", "yes"}).status, 0);
  EXPECT_EQ(wait_for_end()["last_run"]["points"], 1);
  expect_says(queue_text(), "Held: asked for by ");
  std::this_thread::sleep_for(500ms);  // the queue's file follows several times a second
  daemon->signal(SIGKILL);
  daemon->wait();
  daemon = serve();
  expect_says(queue_text(), "Held: asked for by ");
  EXPECT_EQ(json({"queue", "--json"})["jobs"][0]["procedure"], "third");
  expect_refused(fogbench({"queue", "--move", "9"}), 4, "job 9 is not in the queue");
  expect_refused(fogbench({"queue", "--move", "3", "--to", "3"}), 4, "no place 3 in a queue of 2");
  ASSERT_EQ(fogbench({"resume"}).status, 0);
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  const auto runs = json({"runs", "--store", store(), "--json"})["runs"];
  ASSERT_EQ(runs.size(), 3U);
  EXPECT_EQ(runs[1]["procedure"], "third");
  EXPECT_EQ(runs[2]["procedure"], "second");
}

TEST_F(OperatorsTest, AfterARunWithoutAResultOnlyWhatKeepsGoingBegins) {
  const auto daemon = serve();
  const std::string nothing = folder_
                                  .file("nothing.json", R"({"name": "nothing", "steps": [
             {"step": "prompt", "text": "Ready?"},
             {"step": "wait", "duration_s": 2, "segment": "a", "window_s": 60}]})")
                                  .string();
  run(nothing);
  const Finished stubborn =
      fogbench({"run", procedure("stubborn", 1), "--gyro", "A", "--keep-going"});
  ASSERT_EQ(stubborn.status, 0) << stubborn.err;
  run(nothing);
  run(procedure("meek", 1));
  wait_for_prompt();
  ASSERT_EQ(fogbench({"answer", "yes"}).status, 0);
  const auto third = wait_until([](const nlohmann::json& now) {
    return now["prompt"].is_object() && now["last_run"].is_object() &&
           now["last_run"]["procedure"] == "stubborn";
  });
  EXPECT_EQ(third["run"]["run"], 3);
  EXPECT_EQ(stored("1")["outcome"], "failed");
  ASSERT_EQ(fogbench({"answer", "yes"}).status, 0);
  const auto held = wait_until([](const nlohmann::json& now) { return now["run"].is_null(); });
  EXPECT_EQ(held["last_run"]["outcome"], "failed");
  EXPECT_EQ(held["last_run"]["resumable"], false);
  EXPECT_EQ(held["queue"]["held"], true);
  const Finished watched = fogbench({"status"});
  expect_says(watched.out, "nothing was measured");
  EXPECT_EQ(watched.out.find("takes it up"), std::string::npos) << watched.out;
  expect_refused(fogbench({"resume", "3"}), 3, "it has measured nothing");
  expect_refused(fogbench({"resume", "0"}), 2, "there is no run 0");
}

TEST_F(OperatorsTest, AnotherGyroWaitsForAPersonAndNoLongerThanItIsWanted) {
  const auto daemon = serve();
  run(procedure("a", 1), "A");
  wait_for_end();
  const Finished other = fogbench({"run", procedure("b", 1), "--gyro", "B"});
  expect_says(other.out, "The queue is held: the last run was for gyro A, the next needs gyro B");
  run(procedure("a", 1), "A");
  expect_says(queue_text(), "Held: the last run was for gyro A");
  const Finished removed = fogbench({"queue", "--remove", "2"});
  EXPECT_EQ(removed.out.find("Held"), std::string::npos) << removed.out;
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  EXPECT_EQ(json({"runs", "--store", store(), "--json"})["runs"].size(), 2U);
}

TEST_F(OperatorsTest, AnInterruptedRunIsOfferedWhateverCameAfterItOrWhatIsInTheWayIsSaid) {
  auto daemon = serve();
  run(procedure("long", 500));
  wait_until([](const nlohmann::json& now) {
    return now["run"].is_object() && now["run"]["points"].get<int>() > 0;
  });
  daemon->signal(SIGKILL);
  daemon->wait();
  ASSERT_EQ(support::run(dry_run({"static-record", "--set", "duration_s=60"})).status, 0);
  daemon = serve();
  EXPECT_EQ(status()["interrupted"]["run"], 1);
  EXPECT_TRUE(status()["interrupted"]["obstacle"].is_null());
  daemon->signal(SIGTERM);
  daemon->wait();

  const auto config = folder_ / "config";
  std::filesystem::create_directories(config / "benches");
  std::filesystem::copy(tests::source_tree() / "config/devices", config / "devices",
                        std::filesystem::copy_options::recursive);
  std::ifstream ready(tests::source_tree() / "config/benches/simulated.json");
  auto bench = nlohmann::json::parse(ready);
  bench["limits"]["run_time_maximum_s"] = 12345;
  const std::string changed = (config / "benches/simulated.json").string();
  std::ofstream(changed) << bench;
  daemon = started(command({"--bench", changed, "--store", store(), "--speed", "20"}, "fogbenchd"));
  const auto offered = status();
  expect_says(offered["interrupted"]["obstacle"].get<std::string>(), "run_time_maximum_s");
  const Finished shown = fogbench({"status"});
  expect_says(shown.out,
              "fogbench resume 1 --discard gives it up, fogbench run long begins it anew");
  expect_refused(fogbench({"resume", "1"}), 3, "run 1 cannot be taken up");
  EXPECT_EQ(json({"resume", "1", "--discard", "--json"}), nlohmann::json({{"discarded", 1}}));
  EXPECT_TRUE(status()["interrupted"].is_null());
}

TEST_F(OperatorsTest, RunsAreLookedForWhereTheDaemonWrites) {
  const auto daemon = serve();
  run(procedure("a", 1));
  wait_for_end();
  const std::string home = (folder_ / "home").string();
  std::filesystem::create_directory(home);
  const Process::Setup at_home{{"HOME=" + home, "XDG_STATE_HOME=" + home},
                               [] { unsetenv("FOGBENCH_STORE"); }};
  const Finished there = fogbench({"runs"}, at_home);
  EXPECT_EQ(there.status, 0) << there.err;
  expect_says(there.out, "completed");
  expect_says(there.err, store());
  EXPECT_EQ(fogbench({"show", "1"}, at_home).status, 0);

  ASSERT_EQ(fogbench({"dry-run", "static-record", "--set", "duration_s=60"}, at_home).status, 0);
  const Finished own = fogbench({"runs"}, at_home);
  expect_says(own.out, "static-record");
  expect_says(own.err, "the fogbenchd that serves here writes --store " + store());
}

// Other users need root to be played; without it the daemon's own user is all there is.
TEST_F(OperatorsTest, UnprivilegedUsersReadNoFileWithTheDaemonsRights) {
  if (geteuid() != 0) return;
  constexpr uid_t kUserNobody = 65534;
  constexpr gid_t kGroupOfOperators = 1;  // group "daemon" of every Debian
  const std::string client = (folder_ / "client").string();
  std::filesystem::copy_file(tests::build_tree() / "fogbench", client);
  const auto daemon = serve({"--operators", "daemon"});
  const std::string secret = procedure("secret", 1);
  ASSERT_EQ(chmod(secret.c_str(), 0600), 0);
  const auto asks = [&] {
    return support::run({client, "run", secret}, {{}, [] {
                                                    const gid_t group = kGroupOfOperators;
                                                    if (setgroups(1, &group) != 0 ||
                                                        setgid(group) != 0 ||
                                                        setuid(kUserNobody) != 0) {
                                                      _exit(126);
                                                    }
                                                  }});
  };
  expect_refused(asks(), 3, "secret.json");
  ASSERT_EQ(chmod(secret.c_str(), 0640), 0);
  ASSERT_EQ(chown(secret.c_str(), 0, kGroupOfOperators), 0);
  EXPECT_EQ(asks().status, 0) << "his group may read it";
}

}  // namespace
}  // namespace fogbench::system_tests
