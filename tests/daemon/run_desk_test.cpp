// The desk between its two threads, with the engine, the simulated bench and a run log in memory:
// this thread plays the people, the other one is the bench's.

#include "daemon/run_desk.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "daemon/desk_operator.hpp"
#include "daemon/desk_recorder.hpp"
#include "tests/support/memory_recorder.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

using testing::HasSubstr;

constexpr auto kAsks = R"({"name": "asks", "steps": [
  {"step": "set_temperature", "mode": "off"},
  {"step": "prompt", "text": "Turn the gyro."},
  {"step": "average", "duration_s": 2, "segment": "a"}]})";
constexpr auto kMeasures = R"({"name": "measures", "steps": [
  {"step": "set_temperature", "mode": "off"},
  {"step": "average", "duration_s": 2, "segment": "a"}]})";

class RunDeskTest : public testing::Test {
 protected:
  RunDeskTest() {
    const auto ready = tests::source_tree() / "config";
    auto setup = load_setup(
        {(ready / "benches/simulated.json").string(), (ready / "scenarios/clean.json").string()});
    EXPECT_TRUE(setup) << setup.error().message;
    bench_ = setup->bench;
    auto session = Session::open(std::move(*setup), 3, recorder_, Speed::kMaximum, person_);
    EXPECT_TRUE(session) << session.error().message;
    session_ = std::move(*session);
    session_->engine().on_progress([this](const auto& now) { desk_.progressed(now); });
    desk_.attach(session_->engine());
    person_.attach(session_->engine());
    bench_thread_ = std::thread([this] {
      while (const auto job = desk_.next_job()) {
        desk_.run_ended(session_->run(job->procedure, job->by.name));
      }
    });
  }
  ~RunDeskTest() override { leave(); }

  void leave() {
    desk_.close({"SIGTERM", 0});
    if (bench_thread_.joinable()) bench_thread_.join();
  }

  PlannedProcedure planned(const std::string& text) {
    auto plan = plan_procedure(folder_.file("p.json", text).string(), bench_, {});
    EXPECT_TRUE(plan) << plan.error().message;
    return std::move(*plan);
  }
  std::uint64_t enqueue(const std::string& text) {
    const auto queued = desk_.enqueue({}, planned(text), alice_);
    EXPECT_TRUE(std::holds_alternative<std::uint64_t>(queued));
    return std::get<std::uint64_t>(queued);
  }
  /// The first view of which `holds` is true.
  DeskView wait_until(const std::function<bool(const DeskView&)>& holds) {
    for (int i = 0; i < 20000; ++i) {
      DeskView view = desk_.view();
      if (holds(view)) return view;
      std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
    ADD_FAILURE() << "it never came to that";
    return desk_.view();
  }
  DeskView wait_for_question() {
    return wait_until([](const DeskView& view) { return view.question.has_value(); });
  }
  DeskView wait_for_end_of(std::uint64_t job) {
    return wait_until(
        [job](const DeskView& view) { return view.last_run && view.last_run->job == job; });
  }

  const Person alice_{"alice", 1000}, bob_{"bob", 1001};
  support::TemporaryFolder folder_;
  config::BenchConfig bench_;
  test::MemoryRecorder record_;
  RunDesk desk_;
  DeskRecorder recorder_{record_, desk_};
  DeskOperator person_{desk_};
  std::unique_ptr<Session> session_;
  std::thread bench_thread_;
};

TEST_F(RunDeskTest, ARunAsksAndTheRecordSaysWhoDidWhat) {
  const std::uint64_t job = enqueue(kAsks);
  // The bench is watched meanwhile.
  const DeskView asking =
      wait_until([](const DeskView& view) { return view.question && view.values; });
  ASSERT_TRUE(asking.question);
  EXPECT_EQ(asking.question->text, "Turn the gyro.");
  ASSERT_TRUE(asking.run);
  EXPECT_EQ(asking.run->run, 1);
  EXPECT_EQ(asking.run->by, "alice");

  const auto stale = desk_.answer(asking.question->prompt + 1, true, bob_);
  ASSERT_TRUE(stale);
  EXPECT_EQ(stale->code, RpcCode::kNotFound);
  EXPECT_FALSE(desk_.answer(asking.question->prompt, true, bob_));
  const DeskView ended = wait_for_end_of(job);
  EXPECT_EQ(ended.last_run->outcome, "completed") << ended.last_run->reason;
  EXPECT_EQ(ended.last_run->points, 1U);
  EXPECT_TRUE(ended.last_run->safe_state_reached);
  EXPECT_FALSE(ended.question);
  EXPECT_FALSE(ended.run);
  EXPECT_EQ(desk_.ended_runs().size(), 1U);
  leave();
  EXPECT_EQ(record_.headers.at(0).operator_name, "alice");
  EXPECT_TRUE(record_.has_event("run, by alice"));
  const auto asked =
      std::find_if(record_.events.begin(), record_.events.end(),
                   [](const auto& event) { return event.message == "asks: Turn the gyro."; });
  ASSERT_NE(asked, record_.events.end()) << "when the prompt appeared";
  EXPECT_EQ(nlohmann::json::parse(asked->data_json).at("asks"), "Turn the gyro.");
  const auto answered =
      std::find_if(record_.events.begin(), record_.events.end(), [](const auto& event) {
        return event.message == "answer yes to \"Turn the gyro.\", by bob";
      });
  ASSERT_NE(answered, record_.events.end());
  const auto data = nlohmann::json::parse(answered->data_json);
  EXPECT_EQ(data.at("user"), "bob");
  EXPECT_EQ(data.at("uid"), 1001);
}

TEST_F(RunDeskTest, WhatBelongsToNoRunIsTheBenchs) {
  double now_s = 1000.0;
  RunDesk desk;
  desk.dated_by([&now_s] { return now_s; });
  const auto queued = [&] {
    return std::get<std::uint64_t>(desk.enqueue({}, planned(kMeasures), alice_));
  };
  queued();
  queued();
  now_s = 1001.0;
  EXPECT_FALSE(desk.move(2, 1, bob_));
  EXPECT_FALSE(desk.remove(2, bob_));
  EXPECT_TRUE(desk.remove(9, bob_));
  EXPECT_FALSE(desk.hold(alice_));
  EXPECT_FALSE(desk.resume(bob_));
  std::vector<std::string> said;
  const auto events = desk.take_bench_events();
  for (const record::BenchEvent& event : events) said.push_back(event.message);
  EXPECT_THAT(said, testing::ElementsAre(
                        "job 1 queued: measures, gyro SIM-FOG-1, by alice",
                        "job 2 queued: measures, gyro SIM-FOG-1, by alice",
                        "job 2 moved to place 1 of the queue, by bob",
                        "job 2 removed from the queue: measures, gyro SIM-FOG-1, by bob",
                        "hold the queue, by alice",
                        HasSubstr("go on with the queue, which was held (asked for by alice")));
  EXPECT_EQ(events[0].unix_s, 1000.0);
  EXPECT_EQ(events[2].unix_s, 1001.0);
  EXPECT_EQ(events[3].gyro_serial_number, "SIM-FOG-1");
  EXPECT_EQ(nlohmann::json::parse(events[3].data_json).at("uid"), 1001);
  EXPECT_TRUE(desk.take_bench_events().empty());
}

TEST_F(RunDeskTest, AnOrderForOneRunNeverFallsOnTheNext) {
  const std::uint64_t first = enqueue(kAsks);
  bench_.gyro.serial_number = "FOG-42";
  const std::uint64_t second = enqueue(kMeasures);
  EXPECT_EQ(wait_for_question().run->gyro, "SIM-FOG-1");
  EXPECT_FALSE(desk_.pause(alice_));
  EXPECT_FALSE(desk_.abort(bob_));
  const DeskView held = wait_for_end_of(first);
  EXPECT_EQ(held.last_run->outcome, "aborted");
  EXPECT_EQ(held.held_because,
            "the last run was not completed (aborted), the next needs gyro FOG-42 on the bench");
  EXPECT_EQ(held.last_run->gyro, "SIM-FOG-1");
  ASSERT_EQ(desk_.queue().size(), 1U);
  EXPECT_EQ(desk_.queue()[0].gyro, "FOG-42");

  bench_.gyro.serial_number = "FOG-43";
  const std::uint64_t third = enqueue(kMeasures);
  EXPECT_FALSE(desk_.resume(alice_));
  const DeskView changed = wait_for_end_of(second);
  EXPECT_EQ(changed.last_run->outcome, "completed");
  EXPECT_EQ(changed.held_because,
            "the last run was for gyro FOG-42, the next needs gyro FOG-43 on the bench");
  bench_.gyro.serial_number = "FOG-44";
  const std::uint64_t fourth = enqueue(kMeasures);
  EXPECT_FALSE(desk_.remove(third, alice_));
  EXPECT_THAT(desk_.view().held_because, HasSubstr("FOG-44")) << "never a gyro that nobody wants";
  EXPECT_FALSE(desk_.resume(alice_));
  EXPECT_EQ(wait_for_end_of(fourth).held_because, "");
  leave();
  EXPECT_TRUE(record_.has_event("abort, by bob"));
  EXPECT_EQ(record_.ends.size(), 3U);
  EXPECT_EQ(record_.headers.at(0).gyro_serial_number, "SIM-FOG-1");
  EXPECT_EQ(record_.headers.at(1).gyro_serial_number, "FOG-42");
}

TEST_F(RunDeskTest, DecliningAborts) {
  const std::uint64_t job = enqueue(kAsks);
  EXPECT_FALSE(desk_.answer(wait_for_question().question->prompt, false, alice_));
  const DeskView ended = wait_for_end_of(job);
  EXPECT_EQ(ended.last_run->outcome, "aborted");
  EXPECT_THAT(ended.last_run->reason, HasSubstr("declined"));
}

TEST_F(RunDeskTest, PausesBeforeTheNextStep) {
  const std::uint64_t job = enqueue(kAsks);
  const DeskView asking = wait_for_question();
  EXPECT_FALSE(desk_.pause(alice_));
  EXPECT_EQ(desk_.pause(alice_)->code, RpcCode::kWrongState);
  EXPECT_FALSE(desk_.answer(asking.question->prompt, true, alice_));
  const DeskView paused = wait_until([](const DeskView& view) {
    return view.run && view.run->progress.state == procedures::RunState::kPaused;
  });
  EXPECT_EQ(paused.run->points, 0U);
  EXPECT_FALSE(desk_.resume(alice_));
  EXPECT_EQ(wait_for_end_of(job).last_run->outcome, "completed");
}

TEST_F(RunDeskTest, APauseThatFindsNoStepLeftHoldsTheQueueInstead) {
  constexpr auto kAsksLast = R"({"name": "asks_last", "steps": [
    {"step": "set_temperature", "mode": "off"},
    {"step": "prompt", "text": "Is it there?"}]})";
  const std::uint64_t first = enqueue(kAsksLast), second = enqueue(kMeasures);
  const DeskView asking = wait_for_question();
  EXPECT_FALSE(desk_.pause(alice_));
  EXPECT_TRUE(desk_.view().run->pauses_after);
  EXPECT_FALSE(desk_.answer(asking.question->prompt, true, alice_));
  const DeskView held = wait_for_end_of(first);
  EXPECT_EQ(held.last_run->outcome, "completed");
  EXPECT_THAT(held.held_because, HasSubstr("alice paused run 1, which ended first"));
  EXPECT_EQ(held.jobs, 1U);
  EXPECT_FALSE(desk_.resume(bob_));
  EXPECT_EQ(wait_for_end_of(second).held_because, "");
}

TEST_F(RunDeskTest, TheQueueIsHeldAfterTheRunUnderWayAndTheRunGoesOn) {
  const std::uint64_t first = enqueue(kAsks), second = enqueue(kMeasures);
  const DeskView asking = wait_for_question();
  EXPECT_FALSE(desk_.hold(bob_));
  EXPECT_FALSE(desk_.answer(asking.question->prompt, true, alice_));
  const DeskView held = wait_for_end_of(first);
  EXPECT_EQ(held.last_run->points, 1U);
  EXPECT_THAT(held.held_because, HasSubstr("asked for by bob"));
  EXPECT_FALSE(desk_.resume(alice_));
  wait_for_end_of(second);
  leave();
  EXPECT_TRUE(record_.has_event("hold the queue, by bob"));
}

TEST_F(RunDeskTest, AHoldIsTakenBackWhileTheRunIsUnderWay) {
  enqueue(kAsks);
  const std::uint64_t second = enqueue(kMeasures);
  const DeskView asking = wait_for_question();
  EXPECT_FALSE(desk_.hold(bob_));
  EXPECT_FALSE(desk_.resume(bob_));
  EXPECT_TRUE(desk_.resume(bob_)) << "nothing is held any more";
  EXPECT_FALSE(desk_.answer(asking.question->prompt, true, alice_));
  wait_for_end_of(second);
}

TEST_F(RunDeskTest, ARunThatWasToMeasureAndDidNotHasFailed) {
  const std::uint64_t job = enqueue(R"({"name": "nothing", "steps": [
    {"step": "set_temperature", "mode": "off"},
    {"step": "wait", "duration_s": 30, "segment": "a", "window_s": 60}]})");
  const DeskView ended = wait_for_end_of(job);
  EXPECT_EQ(ended.last_run->outcome, "failed");
  EXPECT_THAT(ended.last_run->reason, HasSubstr("nothing was measured"));
  EXPECT_TRUE(ended.last_run->safe_state_reached);
  EXPECT_FALSE(ended.last_run->resumable) << "no step is left of it";
}

TEST_F(RunDeskTest, ClosingAbortsTheRunAndBeginsNoOther) {
  enqueue(kAsks);
  enqueue(kMeasures);
  wait_for_question();
  EXPECT_FALSE(desk_.deserted());
  leave();
  EXPECT_TRUE(desk_.deserted());
  EXPECT_EQ(desk_.view().last_run->outcome, "aborted");
  EXPECT_EQ(record_.headers.size(), 1U);
  EXPECT_TRUE(record_.has_event("abort, by SIGTERM"));
  const auto late = desk_.enqueue({}, planned(kMeasures), alice_);
  EXPECT_EQ(std::get<RpcError>(late).code, RpcCode::kWrongState);
}

TEST_F(RunDeskTest, ARunThatCannotBeRecordedFails) {
  record_.fails = [](const std::string& call) { return call == "begin_run"; };
  const std::uint64_t first = enqueue(kMeasures);
  EXPECT_EQ(wait_for_end_of(first).last_run->outcome, "failed");
  EXPECT_THAT(desk_.view().last_run->reason, HasSubstr("disk full"));
}

TEST_F(RunDeskTest, NothingRunsNothingCanBeStopped) {
  for (const auto& refused : {desk_.pause(alice_), desk_.resume(alice_), desk_.abort(alice_)}) {
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->code, RpcCode::kWrongState);
  }
  EXPECT_EQ(desk_.remove(7, alice_)->code, RpcCode::kNotFound);
  EXPECT_EQ(desk_.answer(1, true, alice_)->code, RpcCode::kNotFound);
}

TEST_F(RunDeskTest, TheQueueHasAnEndAndJobsCanBeTakenOut) {
  enqueue(kAsks);
  wait_for_question();
  const PlannedProcedure procedure = planned(kMeasures);
  std::uint64_t last = 0;
  for (std::size_t i = 0; i < JobQueue::kMostJobs; ++i) {
    last = std::get<std::uint64_t>(desk_.enqueue({}, procedure, alice_));
  }
  const auto full = desk_.enqueue({}, procedure, alice_);
  EXPECT_EQ(std::get<RpcError>(full).code, RpcCode::kQueueFull);
  EXPECT_FALSE(desk_.remove(last, alice_));
  EXPECT_EQ(desk_.remove(last, alice_)->code, RpcCode::kNotFound);
  EXPECT_EQ(desk_.queue().size(), JobQueue::kMostJobs - 1);
}

TEST(RunDesk, APersonResumesWhatAnInterlockHasPaused) {
  RunDesk desk;
  const Person alice{"alice", 1000};
  ASSERT_TRUE(std::holds_alternative<std::uint64_t>(desk.enqueue({}, {}, alice)));
  ASSERT_TRUE(desk.next_job());
  procedures::Progress now;
  now.state = procedures::RunState::kRunning;
  desk.progressed(now);
  ASSERT_TRUE(desk.resume(alice)) << "nobody has paused it";
  now.state = procedures::RunState::kPaused;
  desk.progressed(now);
  EXPECT_FALSE(desk.resume(alice));
}

}  // namespace
}  // namespace fogbench::daemon
