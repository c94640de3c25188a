#include "daemon/job_queue.hpp"

#include <gmock/gmock.h>

namespace fogbench::daemon {
namespace {

using procedures::RunOutcome;
using testing::ElementsAre;
using testing::HasSubstr;

class JobQueueTest : public testing::Test {
 protected:
  std::uint64_t add(const std::string& gyro, Order order = {}) {
    PlannedProcedure procedure;
    procedure.gyro = gyro;
    const auto added = queue_.add(std::move(order), std::move(procedure), alice_);
    EXPECT_TRUE(std::holds_alternative<std::uint64_t>(added));
    return std::get<std::uint64_t>(added);
  }
  /// Begins the next job and ends its run.
  void run(RunOutcome outcome = RunOutcome::kCompleted, bool safe = true) {
    ASSERT_EQ(queue_.held_because(), "");
    queue_.take();
    queue_.recorded();
    queue_.ended(outcome, safe);
  }
  std::vector<std::uint64_t> order() const {
    std::vector<std::uint64_t> jobs;
    for (const Job& job : queue_.jobs()) jobs.push_back(job.job);
    return jobs;
  }
  static Order stubborn() {
    Order order;
    order.keep_going = true;
    return order;
  }

  const Person alice_{"alice", 1000};
  JobQueue queue_;
};

TEST_F(JobQueueTest, AnotherGyroIsPutOnTheBenchByAPersonThoughTheQueueWasEmpty) {
  add("A");
  run();
  add("B");
  EXPECT_EQ(queue_.held_because(),
            "the last run was for gyro A, the next needs gyro B on the bench");
  queue_.go_on();
  run();
  add("B");
  EXPECT_EQ(queue_.held_because(), "");
}

TEST_F(JobQueueTest, AHoldGoesWithItsReason) {
  add("A");
  const auto second = add("A"), other = add("B"), last = add("A");
  run();
  run();
  EXPECT_THAT(queue_.held_because(), HasSubstr("needs gyro B"));
  EXPECT_FALSE(queue_.move(last, 1));
  EXPECT_EQ(queue_.held_because(), "") << "A's job begins now";
  EXPECT_FALSE(queue_.move(last, 2));
  EXPECT_FALSE(queue_.remove(other));
  EXPECT_EQ(queue_.held_because(), "");
  EXPECT_TRUE(queue_.remove(second)) << "it has run";
}

TEST_F(JobQueueTest, WhoGoesOnHasPutTheNextGyroOnTheBenchAndNoOther) {
  add("A");
  run();
  const auto b = add("B");
  add("C");
  queue_.go_on();
  EXPECT_FALSE(queue_.remove(b));
  EXPECT_EQ(queue_.held_because(),
            "the last run was for gyro B, the next needs gyro C on the bench");
}

TEST_F(JobQueueTest, AJobWithoutAGyroMeasuresTheOneThatIsThere) {
  add("A");
  run();
  add("");
  run();
  add("B");
  EXPECT_THAT(queue_.held_because(), HasSubstr("for gyro A")) << "the nameless one was A";
}

TEST_F(JobQueueTest, WhatWaitsBehindAFailureWaitsForAPerson) {
  add("A");
  add("A");
  run(RunOutcome::kFailed);
  EXPECT_THAT(queue_.held_because(), HasSubstr("not completed (failed)"));
  queue_.go_on();
  run(RunOutcome::kAborted);
  add("A");
  EXPECT_EQ(queue_.held_because(), "") << "nothing waited: who asks now knows";
}

TEST_F(JobQueueTest, AJobThatKeepsGoingRunsAfterAFailureOfASafeBenchOnly) {
  add("A");
  add("A", stubborn());
  add("A");
  run(RunOutcome::kFailed);
  run(RunOutcome::kFailed);
  EXPECT_THAT(queue_.held_because(), HasSubstr("not completed (failed)")) << "the third waits";
  queue_.go_on();
  add("A", stubborn());
  run(RunOutcome::kFailed, /*safe=*/false);
  EXPECT_THAT(queue_.held_because(), HasSubstr("not completed (failed)"));
  queue_.go_on();
  add("A", stubborn());
  run(RunOutcome::kAborted);
  EXPECT_THAT(queue_.held_because(), HasSubstr("not completed (aborted)")) << "a person's abort";
}

TEST_F(JobQueueTest, APersonsHoldLastsUntilAPersonGoesOn) {
  add("A");
  queue_.hold("asked for by bob");
  EXPECT_EQ(queue_.held_because(), "asked for by bob, the next needs gyro A on the bench");
  queue_.go_on();
  queue_.take();
  queue_.hold("asked for by bob");
  EXPECT_EQ(queue_.held_because(), "asked for by bob") << "while a run is under way";
  queue_.recorded();
  queue_.ended(RunOutcome::kCompleted, true);
  add("A");
  EXPECT_NE(queue_.held_because(), "");
  queue_.go_on();
  EXPECT_EQ(queue_.held_because(), "");
}

TEST_F(JobQueueTest, ARunThatIsTakenUpGoesFirstAndItsGyroIsInPlace) {
  add("A");
  run();
  add("A");
  queue_.hold("asked for by bob");
  const auto resumed = add("B", Order{{}, {}, 7});
  EXPECT_EQ(queue_.held_because(), "");
  EXPECT_EQ(order().front(), resumed);
  EXPECT_TRUE(queue_.takes_up(7));
  const auto again = queue_.add(Order{{}, {}, 7}, {}, alice_);
  EXPECT_EQ(std::get<RpcError>(again).code, RpcCode::kWrongState);
  run();
  EXPECT_THAT(queue_.held_because(), HasSubstr("needs gyro A"));
}

TEST_F(JobQueueTest, WhatAnEarlierDaemonHadKeepsItsOrderAndWaits) {
  PlannedProcedure procedure;
  queue_.restore({}, procedure, alice_);
  queue_.restore(Order{{}, {}, 7}, procedure, alice_);
  EXPECT_THAT(order(), ElementsAre(1, 2));
  EXPECT_EQ(queue_.held_because(), "the daemon was started anew");
  EXPECT_FALSE(queue_.remove(1));
  EXPECT_FALSE(queue_.remove(2));
  EXPECT_EQ(queue_.held_because(), "");
}

TEST_F(JobQueueTest, JobsAreMovedWithinTheQueue) {
  for (int i = 0; i < 4; ++i) add("A");
  EXPECT_FALSE(queue_.move(4, 1));
  EXPECT_THAT(order(), ElementsAre(4, 1, 2, 3));
  EXPECT_FALSE(queue_.move(4, 4));
  EXPECT_THAT(order(), ElementsAre(1, 2, 3, 4));
  EXPECT_FALSE(queue_.move(2, 3));
  EXPECT_THAT(order(), ElementsAre(1, 3, 2, 4));
  for (const auto& [job, place] : {std::pair{9, 1}, std::pair{1, 0}, std::pair{1, 5}}) {
    EXPECT_EQ(queue_.move(static_cast<std::uint64_t>(job), static_cast<std::uint64_t>(place))->code,
              RpcCode::kNotFound);
  }
  EXPECT_THAT(order(), ElementsAre(1, 3, 2, 4));
}

}  // namespace
}  // namespace fogbench::daemon
