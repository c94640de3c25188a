// A night on one bench: three gyros, two people and one who may only look, a prompt, a pause, an
// abort, a SIGKILL. In the morning the history alone must be enough for a report of it.

#include <gmock/gmock.h>
#include <grp.h>
#include <unistd.h>

#include <csignal>

#include "tests/system/control_fixture.hpp"

namespace fogbench::system_tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Of every Debian.
constexpr uid_t kNobody = 65534, kGames = 5;
constexpr gid_t kGroupDaemon = 1, kGroupGames = 60;

class NightTest : public ControlTest {
 protected:
  NightTest() { std::filesystem::copy_file(tests::build_tree() / "fogbench", client_); }

  /// As the user "nobody", who is an operator.
  Finished colleague(const std::vector<std::string>& arguments) const {
    return as(kNobody, kGroupDaemon, arguments);
  }
  /// As the user "games", who is none.
  Finished visitor(const std::vector<std::string>& arguments) const {
    return as(kGames, kGroupGames, arguments);
  }
  Finished as(uid_t user, gid_t group, std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), client_);
    return support::run(
        arguments, {{}, [user, group] {
                      if (setgroups(1, &group) != 0 || setgid(group) != 0 || setuid(user) != 0) {
                        _exit(126);
                      }
                    }});
  }
  static void expect_done(const Finished& done) { EXPECT_EQ(done.status, 0) << done.err; }
  /// What the history says, one line each, in its order.
  std::vector<std::string> said(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"history", "--store", store(), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    std::vector<std::string> sentences;
    const auto document = json(arguments);
    for (const auto& one : document["history"]) sentences.push_back(one["message"]);
    return sentences;
  }
  static void wait_for_run(int run) {
    wait_until([run](const nlohmann::json& now) {
      return now["run"].is_object() && now["run"]["run"] == run && now["run"]["points"] > 0;
    });
  }

  const std::string client_ = (folder_ / "client").string();
};

TEST_F(NightTest, TheHistoryAloneIsEnoughForAReport) {
  if (geteuid() != 0) return;  // other users need root to be played
  auto daemon = serve({"--operators", "daemon"});
  expect_done(fogbench({"run", procedure("first", 2, "Is the door shut?"), "--gyro", "FOG-A"}));
  expect_done(fogbench({"run", procedure("second", 400), "--gyro", "FOG-B"}));
  expect_done(fogbench({"run", procedure("third", 30), "--gyro", "FOG-C"}));
  wait_for_prompt();
  expect_refused(visitor({"abort"}), 4, "permission denied: games may not abort");
  expect_done(colleague({"answer", "yes"}));
  EXPECT_EQ(fogbench({"watch"}).status, 0);

  expect_done(colleague({"resume"}));  // FOG-B is on the bench
  wait_for_run(2);
  expect_done(fogbench({"pause"}));
  wait_until([](const nlohmann::json& now) { return now["state"] == "paused"; });
  expect_done(colleague({"resume"}));
  expect_done(colleague({"abort"}));
  EXPECT_EQ(fogbench({"watch"}).status, 4) << "the last run did not complete";
  const auto idle = status();
  for (const char* old : {"run", "values", "values_age_s"})
    EXPECT_TRUE(idle[old].is_null()) << idle;
  EXPECT_TRUE(idle["old_values"].empty());

  expect_done(fogbench({"resume"}));
  wait_for_run(3);
  daemon->signal(SIGKILL);
  daemon->wait();
  EXPECT_THAT(fogbench({"runs", "--store", store()}).out, HasSubstr("interrupted"));
  daemon = serve({"--operators", "daemon"});
  expect_done(colleague({"resume", "3"}));
  wait_until([](const nlohmann::json& now) { return now["run"].is_object(); });
  EXPECT_THAT(fogbench({"runs", "--store", store()}).out, HasSubstr("under way"));
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  daemon->signal(SIGTERM);
  EXPECT_EQ(daemon->wait().status, 0);

  const std::vector<std::string> sentences = said();
  std::size_t at = 0;
  for (const char* expected :
       {"started, bench simulated: ",
        "job 1 queued: first, gyro FOG-A, by root",
        "run 1 begins: first, gyro FOG-A, bench simulated, asked for by root",
        "run, by root (job 1)",
        "asks: Is the door shut?",
        "answer yes to \"Is the door shut?\", by nobody",
        "run 1 completed after",
        "go on with the queue, which was held (the last run was for gyro FOG-A, the next needs "
        "gyro FOG-B on the bench), by nobody",
        "run 2 begins: second, gyro FOG-B",
        "operating time of gyro FOG-B counts from 20",
        "pause, by root",
        "resume, by nobody",
        "abort, by nobody",
        "run 2 aborted after",
        "go on with the queue, which was held (the last run was not completed (aborted), the next "
        "needs gyro FOG-C on the bench), by root",
        "run 3 begins: third, gyro FOG-C",
        "run 3 was interrupted: ",
        "did not stop by itself: it was killed, it crashed, or the power was cut",
        "job 4 queued: third, taking up run 3, gyro FOG-C, by nobody",
        "run 4 begins: third, gyro FOG-C",
        "takes up run 3 at step ",
        "run 4 completed after",
        "SIGTERM: the daemon stops",
        "fogbenchd stopped; the bench is in its safe state"}) {
    std::size_t found = at;
    while (found < sentences.size() && sentences[found].find(expected) == std::string::npos) {
      ++found;
    }
    ASSERT_LT(found, sentences.size()) << expected << " is not in\n"
                                       << fogbench({"history", "--store", store()}).out;
    at = found;
  }
  const Finished text = fogbench({"history", "--store", store()});
  EXPECT_THAT(text.out, HasSubstr("warning: refused: games may not abort"));
  EXPECT_THAT(text.out, HasSubstr("outcome"));

  // Of one gyro nothing that is another's.
  std::string of_c;
  for (const std::string& sentence : said({"--gyro", "FOG-C"})) of_c += sentence + "\n";
  EXPECT_THAT(of_c, HasSubstr("run 3 begins"));
  EXPECT_THAT(of_c, Not(HasSubstr("FOG-A, by")));
  EXPECT_THAT(of_c, Not(HasSubstr("run 2")));

  const auto page = folder_ / "night.html";
  expect_done(fogbench({"history", "--store", store(), "--html", page.string()}));
  const std::string html = support::read_text(page);
  EXPECT_THAT(html, HasSubstr("<td>FOG-B</td>"));
  EXPECT_THAT(html, HasSubstr("asks: Is the door shut?"));
}

TEST_F(NightTest, WhatBelongsToOneGyroStaysWithIt) {
  auto daemon = serve();
  const auto waits = [&](const char* name) {
    return folder_
        .file(std::string(name) + ".json", std::string(R"({"name": ")") + name + R"(", "steps": [
               {"step": "wait", "operating_time_s": 60},
               {"step": "average", "duration_s": 2, "segment": "a"}]})")
        .string();
  };
  // How long the first point of a run came after the gyro's power-on.
  const auto first_point_s = [&](const char* run) {
    const auto record = stored(run);
    EXPECT_EQ(record["outcome"], "completed");
    return record["measured"][0]["time_s"].get<double>();
  };
  json({"run", waits("a"), "--gyro", "A", "--json"});
  wait_until([](const nlohmann::json& now) { return now["last_run"].is_object(); });
  std::this_thread::sleep_for(std::chrono::seconds{2});  // 40 s of the bench
  json({"run", waits("a-again"), "--gyro", "A", "--json"});
  json({"run", waits("b"), "--gyro", "B", "--json"});
  json({"run", waits("b-warm"), "--gyro", "B", "--json"});
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  EXPECT_GT(first_point_s("2"), 61.0 + 30.0) << "the same gyro, which stayed on";
  ASSERT_EQ(fogbench({"resume"}).status, 0);
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  EXPECT_NEAR(first_point_s("3"), 61.0, 3.0) << "warmed up for itself";
  EXPECT_LT(stored("3")["stream"]["frames_missing"].get<int>(), 300);
  EXPECT_GT(first_point_s("4"), 62.0);

  // Who knows better says so.
  json({"run", waits("c"), "--gyro", "C", "--gyro-on-since", "3h", "--json"});
  ASSERT_EQ(fogbench({"resume"}).status, 0);
  EXPECT_EQ(fogbench({"watch"}).status, 0);
  EXPECT_GT(first_point_s("5"), 3.0 * 3600.0 - 60.0);
  EXPECT_TRUE(has_event(stored("5"), "operating time of gyro C counts from 20"));
  EXPECT_TRUE(has_event(stored("5"), " says"));
  expect_refused(fogbench({"run", waits("c"), "--gyro-on-since", "yesterday"}), 2,
                 "--gyro-on-since: found \"yesterday\", expected a date");

  // Numbers of jobs go on though nothing waited.
  daemon->signal(SIGTERM);
  daemon->wait();
  daemon = serve();
  EXPECT_EQ(json({"run", waits("d"), "--json"})["job"], 6);
}

}  // namespace
}  // namespace fogbench::system_tests
