#include "procedures/run_state.hpp"

#include <gtest/gtest.h>

#include <map>

#include "tests/procedures/engine_fixture.hpp"

namespace fogbench::procedures {
namespace {

using S = RunState;
using E = RunEvent;

TEST(RunState, AllowsWhatTheHeaderDrawsAndRefusesTheRest) {
  const std::map<std::pair<S, E>, S> drawn{
      {{S::kIdle, E::kStart}, S::kRunning},          {{S::kRunning, E::kPause}, S::kPaused},
      {{S::kPaused, E::kResume}, S::kRunning},       {{S::kRunning, E::kDone}, S::kStopping},
      {{S::kRunning, E::kAbort}, S::kStopping},      {{S::kRunning, E::kFail}, S::kStopping},
      {{S::kPaused, E::kAbort}, S::kStopping},       {{S::kPaused, E::kFail}, S::kStopping},
      {{S::kStopping, E::kSafeDone}, S::kCompleted}, {{S::kStopping, E::kSafeAborted}, S::kAborted},
      {{S::kStopping, E::kSafeFailed}, S::kFailed},  {{S::kCompleted, E::kStart}, S::kRunning},
      {{S::kAborted, E::kStart}, S::kRunning},       {{S::kFailed, E::kStart}, S::kRunning},
  };
  for (int s = 0; s <= static_cast<int>(S::kFailed); ++s) {
    for (int e = 0; e <= static_cast<int>(E::kSafeFailed); ++e) {
      const auto found = drawn.find({static_cast<S>(s), static_cast<E>(e)});
      const auto next = next_state(static_cast<S>(s), static_cast<E>(e));
      if (found == drawn.end()) {
        EXPECT_FALSE(next) << s << " " << e;
      } else {
        ASSERT_TRUE(next) << s << " " << e;
        EXPECT_EQ(*next, found->second);
      }
    }
  }
}

TEST(RunState, HasANameForEach) {
  EXPECT_EQ(name_of(S::kIdle), "idle");
  EXPECT_EQ(name_of(S::kFailed), "failed");
}

TEST(RunState, ARunWithinARunIsRefused) {
  test::Rig rig;
  const Plan plan = rig.plan({test::wait(5.0)});
  int refused = 0;
  rig.engine.on_progress([&](const Progress& p) {
    if (p.state != RunState::kRunning) return;
    const auto second = rig.engine.run(plan, RunHeader{});
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, ErrorCode::kUsage);
    ++refused;
  });
  const auto summary = rig.engine.run(plan, RunHeader{});
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->end.outcome, RunOutcome::kCompleted);
  EXPECT_GT(refused, 0);
}

TEST(RunState, AnEngineRunsAgainAfterAnEnd) {
  test::Rig rig;
  EXPECT_EQ(rig.summary_of({test::average()}).run, 1);
  EXPECT_EQ(rig.summary_of({test::average()}).run, 2);
  EXPECT_EQ(rig.log.points.size(), 2U);
}

}  // namespace
}  // namespace fogbench::procedures
