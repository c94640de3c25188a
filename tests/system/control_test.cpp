// The daemon as a service and its clients as operators type them. Only real processes have users,
// signals, sockets that systemd hands over, and two threads of their own.

#include <grp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/system/control_fixture.hpp"

namespace fogbench::system_tests {
namespace {

using namespace std::chrono_literals;

constexpr gid_t kOperators = 1;     // group "daemon" of every Debian
constexpr uid_t kStranger = 65534;  // nobody

TEST_F(ControlTest, RunsWhatIsQueuedAndSaysHowItEnded) {
  const auto daemon = serve();
  EXPECT_EQ(status()["state"], "idle");
  const auto queued = json({"run", procedure("first", 6, "Ready?"), "--gyro", "FOG-42", "--json"});
  EXPECT_EQ(queued["job"], 1);
  EXPECT_EQ(queued["steps"], 8);
  wait_for_prompt();
  const Finished second = fogbench({"run", procedure("second", 1), "--gyro", "FOG-42"});
  EXPECT_EQ(second.status, 0) << second.err;
  EXPECT_NE(second.out.find("Job 2"), std::string::npos) << second.out;
  EXPECT_NE(second.out.find(", gyro FOG-42: "), std::string::npos) << second.out;

  Process quiet(command({"watch", "--every", "0.1"}));
  Process follows(command({"watch", "--json"}));
  ASSERT_TRUE(follows.wait_for_output("Ready?", 30s));
  EXPECT_EQ(fogbench({"answer", "yes"}).status, 0);
  EXPECT_EQ(follows.wait().status, 0);
  const Finished watched = quiet.wait();
  EXPECT_EQ(watched.status, 0) << watched.err;
  EXPECT_EQ(std::count(watched.out.begin(), watched.out.end(), '\n'), 1)
      << "quiet but for the end: " << watched.out;
  EXPECT_NE(watched.out.find("run 2, second, gyro FOG-42: completed"), std::string::npos)
      << watched.out;
  EXPECT_EQ(watched.err, "");
  EXPECT_EQ(fogbench({"queue"}).out, "The queue is empty.\n");

  const auto runs = json({"runs", "--store", store(), "--json"})["runs"];
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0]["outcome"], "completed");
  EXPECT_EQ(runs[0]["points"], 6);
  EXPECT_TRUE(has_event(stored("1"), "run, by ")) << stored("1")["events"];

  expect_refused(fogbench({"run", "no-such"}), 3, "coil-sweep");
  expect_refused(fogbench({"run", "coil-sweep", "--set", "levels_ut=0,900"}), 3, "900");
  for (const char* gyro : {"", " FOG-42", "FOG\n42", "FOG-\xff"}) {
    expect_refused(fogbench({"run", "coil-sweep", "--gyro", gyro}), 2, "1 to 64 bytes on one line");
  }
  expect_refused(fogbench({"pause"}), 4, "nothing is running");
  expect_refused(fogbench({"abort"}), 4, "nothing is running");
  expect_refused(fogbench({"resume"}), 4, "nothing is running");
  expect_refused(fogbench({"answer", "yes"}), 4, "no prompt waits");
  expect_refused(fogbench({"queue", "--remove", "9"}), 4, "job 9 is not in the queue");
  EXPECT_EQ(fogbench({"answer", "perhaps"}).status, 2);

  daemon->signal(SIGTERM);
  const Finished stopped = daemon->wait(30s);
  EXPECT_EQ(stopped.status, 0) << stopped.err;
  EXPECT_FALSE(std::filesystem::exists(socket()));
  expect_refused(fogbench({"status"}), 4, "no fogbenchd serves " + socket());
}

TEST_F(ControlTest, PausesResumesAndAbortsToTheSafeState) {
  const auto daemon = serve();
  json({"run", procedure("long", 500), "--json"});
  json({"run", procedure("next", 1), "--json"});
  wait_until(
      [](const nlohmann::json& now) { return now["run"].is_object() && now["run"]["points"] > 0; });
  EXPECT_EQ(json({"pause", "--json"}), nlohmann::json({{"pauses", "before_next_step"}}));
  const auto paused =
      wait_until([](const nlohmann::json& now) { return now["state"] == "paused"; });
  EXPECT_EQ(paused["run"]["procedure"], "long");
  EXPECT_GT(paused["run"]["remaining_s"], 1.0);
  EXPECT_TRUE(paused["values"]["temperature_working_1_c"].is_number());
  std::this_thread::sleep_for(600ms);
  EXPECT_EQ(status()["run"]["points"], paused["run"]["points"]) << "3 s of the bench later";
  const Finished shown = fogbench({"status"});
  EXPECT_NE(shown.out.find("paused: run 1, long"), std::string::npos) << shown.out;
  EXPECT_NE(shown.out.find("degC"), std::string::npos) << shown.out;

  EXPECT_EQ(json({"resume", "--json"}), nlohmann::json({{"resumed", true}}));
  wait_until(
      [&](const nlohmann::json& now) { return now["run"]["points"] > paused["run"]["points"]; });
  const Finished aborted = fogbench({"abort"});
  EXPECT_EQ(aborted.status, 0) << aborted.err;
  EXPECT_NE(aborted.out.find("in its safe state"), std::string::npos) << aborted.out;
  const auto held = status();
  EXPECT_EQ(held["last_run"]["outcome"], "aborted");
  EXPECT_EQ(held["queue"]["held"], true);
  EXPECT_NE(fogbench({"queue"}).out.find("Held"), std::string::npos);
  const auto record = stored("1");
  for (const char* action : {"pause, by ", "resume, by ", "abort, by "}) {
    EXPECT_TRUE(has_event(record, action)) << action << record["events"];
  }
  ASSERT_EQ(fogbench({"resume"}).status, 0);
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  EXPECT_EQ(json({"runs", "--store", store(), "--json"})["runs"][1]["outcome"], "completed");
}

TEST_F(ControlTest, AnyClientAnswersAPrompt) {
  const auto daemon = serve();
  json({"run", procedure("asks", 1, "Turn the gyro."), "--json"});
  EXPECT_EQ(wait_for_prompt()["prompt"]["text"], "Turn the gyro.");
  expect_refused(fogbench({"answer", "yes", "--prompt", "99"}), 4, "prompt 99 does not wait");
  const Finished yes = fogbench({"answer", "yes"});
  EXPECT_EQ(yes.out, "Answered yes: Turn the gyro.\n") << yes.err;
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  EXPECT_TRUE(has_event(stored("1"), "answer yes to \"Turn the gyro.\", by "));

  json({"run", procedure("asks", 1, "Turn the gyro."), "--json"});
  wait_for_prompt();
  const auto answered = json({"answer", "no", "--json"});
  EXPECT_EQ(answered["answer"], "no");
  EXPECT_EQ(answered["text"], "Turn the gyro.");
  const auto after = wait_until([](const nlohmann::json& now) { return now["run"].is_null(); });
  EXPECT_EQ(after["last_run"]["outcome"], "aborted");
  EXPECT_EQ(after["last_run"]["safe_state_reached"], true);
}

TEST_F(ControlTest, ASignalAbortsAndSeveralOfOneEventAbortOnce) {
  for (const auto& event : {std::vector{SIGTERM}, {SIGHUP, SIGHUP}, {SIGTERM, SIGINT, SIGTERM}}) {
    auto daemon = serve();
    const auto job = json({"run", procedure("asks", 1, "Wait."), "--json"});
    wait_for_prompt();
    for (const int number : event) {
      daemon->signal(number);
      std::this_thread::sleep_for(5ms);
    }
    const Finished stopped = daemon->wait(30s);
    EXPECT_EQ(stopped.status, 0) << stopped.err;
    const auto runs = json({"runs", "--store", store(), "--json"})["runs"];
    const auto run = stored(std::to_string(runs.size()));
    EXPECT_EQ(run["outcome"], "aborted");
    EXPECT_EQ(run["safe_state_reached"], true);
    EXPECT_TRUE(has_event(run, event[0] == SIGHUP ? "abort, by SIGHUP" : "abort, by SIGTERM"));
  }
}

TEST_F(ControlTest, ASignalThreeSecondsAfterTheFirstEndsAtOnce) {
  // In real time the turntable takes 20 s, and an abort waits for it.
  auto daemon =
      std::make_unique<Process>(command({"--bench", "simulated", "--store", store()}, "fogbenchd"));
  for (int i = 0; i < 300 && fogbench({"status"}).status != 0; ++i) {
    std::this_thread::sleep_for(100ms);
  }
  const auto turn = folder_.file(
      "turn.json", R"({"name": "turn", "steps": [{"step": "rotate", "azimuth_deg": 90}]})");
  json({"run", turn.string(), "--json"});
  wait_until([](const auto& now) {
    return now["run"].is_object() &&
           now["run"]["says"].template get<std::string>().find("90 deg") != std::string::npos;
  });
  daemon->signal(SIGTERM);
  std::this_thread::sleep_for(1s);
  daemon->signal(SIGTERM);
  std::this_thread::sleep_for(2500ms);
  EXPECT_EQ(status()["stopping"], true) << "the second one came too soon";
  daemon->signal(SIGINT);
  const Finished forced = daemon->wait(10s);
  EXPECT_EQ(forced.status, 4) << forced.err;
  EXPECT_NE(
      forced.err.find("a second signal, SIGINT: ending at once, the bench is NOT in its safe"),
      std::string::npos)
      << forced.err;

  daemon = serve();  // what the forced end left is no hindrance
  json({"run", procedure("asks", 1, "Wait."), "--json"});
  wait_for_prompt();
  const Finished client = fogbench({"abort", "--force"});
  EXPECT_EQ(client.status, 0) << client.err;
  EXPECT_EQ(daemon->wait(30s).status, 4);
}

TEST_F(ControlTest, OneBenchHasOneDaemonAndItWaitsForPeople) {
  const auto daemon = serve();
  const Finished second = support::run(daemon_command());
  EXPECT_EQ(second.status, 4);
  EXPECT_NE(second.err.find("is held by process"), std::string::npos) << second.err;
  EXPECT_EQ(status()["state"], "idle");
  const Finished virtual_clock = support::run(
      command({"--bench", "simulated", "--store", store(), "--speed", "max"}, "fogbenchd"));
  EXPECT_EQ(virtual_clock.status, 2);
  EXPECT_NE(virtual_clock.err.find("waits for nobody"), std::string::npos) << virtual_clock.err;
  EXPECT_EQ(support::run(daemon_command({"--operators", "no such group"})).status, 3);
  EXPECT_EQ(support::run(daemon_command({"--socket", "x", "coil-sweep"})).status, 2);
}

TEST_F(ControlTest, SystemdHandsItsSocketOver) {
  const Process::Setup activated{
      {}, [path = socket()] {
        const int listening = ::socket(AF_UNIX, SOCK_STREAM, 0);
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        path.copy(address.sun_path, sizeof address.sun_path - 1);
        if (bind(listening, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
            listen(listening, 10) != 0 || dup2(listening, 3) != 3) {
          _exit(126);
        }
        setenv("LISTEN_PID", std::to_string(getpid()).c_str(), 1);
        setenv("LISTEN_FDS", "1", 1);
      }};
  const auto daemon = serve({}, activated);
  EXPECT_EQ(status()["state"], "idle");
  daemon->signal(SIGTERM);
  EXPECT_EQ(daemon->wait(30s).status, 0);
  EXPECT_TRUE(std::filesystem::exists(socket())) << "it is systemd's";
}

/// Runs `program` as that user, with one group.
Process::Setup as_user(uid_t user, gid_t group) {
  return {{}, [user, group] {
            if (setgroups(1, &group) != 0 || setgid(group) != 0 || setuid(user) != 0) _exit(126);
          }};
}

// Other users need root to be played; without it the daemon's own user is all there is.
TEST_F(ControlTest, UnprivilegedUsersGetAPermissionError) {
  if (geteuid() != 0) return;
  const std::string client = (folder_ / "client").string();
  std::filesystem::copy_file(tests::build_tree() / "fogbench", client);
  const auto as = [&](uid_t user, gid_t group, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), client);
    return support::run(arguments, as_user(user, group));
  };
  auto daemon = serve();
  expect_refused(as(kStranger, kStranger, {"status"}), 4, "permission denied");
  daemon->signal(SIGTERM);
  EXPECT_EQ(daemon->wait(30s).status, 0);

  daemon = serve({"--operators", "daemon"});
  EXPECT_EQ(as(kStranger, kStranger, {"status"}).status, 0) << "everybody may look";
  for (const std::vector<std::string>& action : {std::vector<std::string>{"run", "coil-sweep"},
                                                 {"pause"},
                                                 {"abort"},
                                                 {"abort", "--force"},
                                                 {"resume"},
                                                 {"queue", "--remove", "1"}}) {
    expect_refused(as(kStranger, kStranger, action), 4, "permission denied: nobody may not");
  }
  EXPECT_EQ(status()["state"], "idle");
  const Finished allowed = as(kStranger, kOperators, {"run", "static-record"});
  EXPECT_EQ(allowed.status, 0) << allowed.err;
  EXPECT_EQ(as(kStranger, kOperators, {"abort"}).status, 0);
  EXPECT_TRUE(has_event(stored("1"), "abort, by nobody"));
  daemon->signal(SIGTERM);
  EXPECT_EQ(daemon->wait(30s).status, 0);

  daemon = serve({"--observers", "daemon"});
  expect_refused(as(kStranger, kStranger, {"status"}), 4, "permission denied: nobody may not");
  EXPECT_EQ(as(kStranger, kOperators, {"status"}).status, 0);
  expect_refused(as(kStranger, kOperators, {"pause"}), 4, "permission denied: nobody may not");
}

}  // namespace
}  // namespace fogbench::system_tests
