#include "daemon/resumption.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/simulated_operator.hpp"
#include "record/run_log.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

using testing::HasSubstr;

/// A store with one run of two averages, which ended in the middle of the second one.
class ResumptionTest : public testing::Test {
 protected:
  ResumptionTest() {
    const auto ready = tests::source_tree() / "config";
    auto setup = load_setup(
        {(ready / "benches/simulated.json").string(), (ready / "scenarios/clean.json").string()});
    EXPECT_TRUE(setup) << setup.error().message;
    setup_ = std::move(*setup);
    const auto file = folder_.file("two.json", R"({"name": "two", "steps": [
        {"step": "average", "duration_s": 5, "segment": "a"},
        {"step": "average", "duration_s": 5, "segment": "b"}]})");
    auto planned = plan_procedure(file.string(), setup_.bench, {});
    EXPECT_TRUE(planned) << planned.error().message;
    std::filesystem::remove(file);  // the record is enough
    header_.procedure = "two";
    header_.procedure_json = planned->procedure_json;
    header_.bench = setup_.bench.name;
    header_.bench_json = setup_.bench_json;
    header_.scenario_json = setup_.scenario_json;
    header_.started_at = "2026-01-01T00:00:00Z";
  }

  void interrupt(const std::string& gyro = "SIM-FOG-1") {
    header_.gyro_serial_number = gyro;
    const auto log = record::RunLog::open(store_);
    ASSERT_TRUE(log) << log.error().message;
    ASSERT_TRUE((*log)->begin_run(header_, {{"gyro", identity_, gyro, "", ""}}));
    ASSERT_TRUE((*log)->step_started("1", "average", 0.0));
    procedures::Point point;
    point.segment = "a";
    point.time_s = 2.5;
    point.duration_s = 5.0;
    ASSERT_TRUE((*log)->point(point));
    ASSERT_TRUE((*log)->step_ended("1", 5.0, ""));
    ASSERT_TRUE((*log)->step_started("2", "average", 5.0));
  }
  Result<PlannedProcedure> plan(std::int64_t run = 1) {
    const auto log = record::RunLogReader::open(store_);
    EXPECT_TRUE(log) << log.error().message;
    return plan_resumption(**log, run, setup_);
  }
  std::string refusal(std::int64_t run = 1) {
    const auto planned = plan(run);
    if (planned) return "taken up";
    EXPECT_EQ(planned.error().code, ErrorCode::kBadInput);
    return planned.error().message;
  }

  std::int64_t offered() {
    const auto log = record::RunLogReader::open(store_);
    const auto runs = interrupted_runs(**log, setup_);
    EXPECT_TRUE(runs) << runs.error().message;
    return runs && !runs->empty() ? runs->back().run : 0;
  }

  support::TemporaryFolder folder_;
  std::filesystem::path store_{folder_ / "store.db"};
  daemon::Setup setup_;
  procedures::RunHeader header_;
  std::string identity_ = "KVH 1750/DSP-1760 layout, rotation rate in deg/s";
};

TEST_F(ResumptionTest, GoesOnAtTheStepThatWasInterruptedWithTheRecordedProcedure) {
  interrupt();
  const auto planned = plan();
  ASSERT_TRUE(planned) << planned.error().message;
  ASSERT_EQ(planned->plan.steps.size(), 1U);
  EXPECT_EQ(planned->plan.steps[0].path, "2");
  EXPECT_EQ(planned->takes_up->continuation.first_step, "2");
  EXPECT_EQ(planned->procedure_json, header_.procedure_json);
  EXPECT_EQ(planned->takes_up->stopped_at_s, drivers::seconds_of_utc("2026-01-01T00:00:05Z"));
}

TEST_F(ResumptionTest, OnlyARunOfThisVeryBenchIsTakenUp) {
  auto files = nlohmann::json::parse(setup_.bench_json);
  auto bench = nlohmann::json::parse(files.at("simulated.json").get<std::string>());
  bench["limits"]["run_time_maximum_s"] = 12345;
  files["simulated.json"] = bench.dump();
  header_.bench_json = files.dump();
  interrupt();
  EXPECT_THAT(refusal(), HasSubstr("simulated.json: /limits/run_time_maximum_s"));
  header_.bench_json = setup_.bench_json + " ";  // the same in other letters
  interrupt();
  EXPECT_EQ(refusal(2), "taken up");
  EXPECT_EQ(offered(), 2);
  header_.bench_json = setup_.bench_json;
  header_.scenario_json += " ";
  interrupt();
  EXPECT_THAT(refusal(3), HasSubstr("another scenario"));
  header_.scenario_json = setup_.scenario_json;
  header_.bench = "factory";
  interrupt();
  EXPECT_THAT(refusal(4), HasSubstr("it is of bench factory, expected simulated"));
  EXPECT_THAT(refusal(5), HasSubstr("no run 5"));
}

TEST_F(ResumptionTest, ADamagedRecordIsSaidToBeOne) {
  for (const char* record : {"", "{", "[]", R"({"files": {}, "parameters": {}})",
                             R"({"files": {"a.json": 7}, "parameters": {}})",
                             R"({"files": {"a.json": "{}"}, "parameters": {"x": "y"}})"}) {
    header_.procedure_json = record;
    std::filesystem::remove(store_);
    interrupt();
    EXPECT_FALSE(plan()) << record;
  }
}

TEST_F(ResumptionTest, OtherInstrumentsThanThoseOfTheRecordDoNotGoOn) {
  const auto take_up = [this](std::int64_t run) {
    auto planned = plan(run);
    EXPECT_TRUE(planned) << planned.error().message;
    SimulatedOperator person;
    const auto session = Session::open(setup_, 1, store_, Speed::kMaximum, person);
    EXPECT_TRUE(session) << session.error().message;
    return (*session)->run(*planned);
  };
  const std::string simulated = std::exchange(identity_, "ANOTHER");
  interrupt();
  identity_ = simulated;
  const auto refused = take_up(1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kDevice);
  EXPECT_THAT(refused.error().message,
              HasSubstr("expected \"ANOTHER\", serial number \"SIM-FOG-1\", which measured"));
  EXPECT_EQ(refusal(1), "taken up") << "nothing was begun: it can still be taken up";

  interrupt();
  const auto done = take_up(2);
  ASSERT_TRUE(done) << done.error().message;
  const auto log = record::RunLogReader::open(store_);
  const auto points = (*log)->chain_points(done->run);
  ASSERT_TRUE(points);
  ASSERT_EQ(points->size(), 2U);
  EXPECT_EQ((*points)[1].point.segment, "b");
  EXPECT_GT((*points)[1].point.time_s, 7.0) << "on one axis of time";
  EXPECT_THAT(refusal(2), HasSubstr("did already"));
  EXPECT_THAT(refusal(done->run), HasSubstr("it was completed"));
}

TEST_F(ResumptionTest, GoesOnWithTheGyroOfTheRecordWhateverTheDaemonsIs) {
  interrupt("FOG-42");
  setup_.bench.gyro.serial_number = "FOG-7";
  const auto planned = plan();
  ASSERT_TRUE(planned) << planned.error().message;
  EXPECT_EQ(planned->gyro, "FOG-42");
  SimulatedOperator person;
  const auto session = Session::open(setup_, 1, store_, Speed::kMaximum, person);
  ASSERT_TRUE(session) << session.error().message;
  const auto done = (*session)->run(*planned);
  ASSERT_TRUE(done) << done.error().message;
  const auto log = record::RunLogReader::open(store_);
  EXPECT_EQ((*log)->run(done->run)->header.gyro_serial_number, "FOG-42");
  const auto instruments = (*log)->instruments(done->run);
  EXPECT_TRUE(std::any_of(instruments->begin(), instruments->end(), [](const auto& instrument) {
    return instrument.role == "gyro" && instrument.serial_number == "FOG-42";
  }));
}

TEST_F(ResumptionTest, TwoRunsNeverTakeUpTheSame) {
  interrupt();
  const auto first = plan(), second = plan();
  ASSERT_TRUE(first && second);
  SimulatedOperator person;
  const auto session = Session::open(setup_, 1, store_, Speed::kMaximum, person);
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE((*session)->run(*first));
  const auto refused = (*session)->run(*second);
  ASSERT_FALSE(refused) << "it was planned before the first had begun";
  EXPECT_THAT(refused.error().message, HasSubstr("run 1 cannot be taken up: run 2 did already"));
  EXPECT_THAT(refusal(3), HasSubstr("no run 3"));
}

TEST_F(ResumptionTest, ARunThatNobodyEndedIsOfferedWhateverCameAfterIt) {
  interrupt();
  interrupt();
  const auto log = record::RunLog::open(store_);
  ASSERT_TRUE((*log)->begin_run(header_, {}));
  ASSERT_TRUE(
      (*log)->end_run({procedures::RunOutcome::kCompleted, "all steps done", true, "", {}}));
  EXPECT_EQ(offered(), 2) << "a dry run into the same run log, above all";
  ASSERT_TRUE((*log)->give_up(2, "given up by alice"));
  EXPECT_EQ(offered(), 1);
  ASSERT_TRUE((*log)->give_up(1, "given up by alice"));
  EXPECT_EQ(offered(), 0);
}

TEST_F(ResumptionTest, WhatHasMeasuredNothingAndHasNoStepLeftIsBegunAnew) {
  {
    const auto log = record::RunLog::open(store_);
    ASSERT_TRUE((*log)->begin_run(header_, {}));
    for (const char* path : {"1", "2"}) {
      ASSERT_TRUE((*log)->step_started(path, "a step", 0.0));
      ASSERT_TRUE((*log)->step_ended(path, 1.0, ""));
    }
    ASSERT_TRUE((*log)->end_run({procedures::RunOutcome::kFailed, "no points", true, "", {}}));
  }
  EXPECT_THAT(refusal(1), HasSubstr("it has measured nothing, and no step is left of it"));
}

TEST_F(ResumptionTest, WhatAnotherProgramWritesIsNotInterrupted) {
  interrupt();
  auto other = record::RunLog::open(store_);
  ASSERT_TRUE(other) << other.error().message;
  ASSERT_TRUE((*other)->begin_run(header_, {}));
  EXPECT_EQ(offered(), 1) << "run 2 is under way: it neither waits nor hides what does";
  EXPECT_THAT(refusal(2), HasSubstr("run 2 cannot be taken up: it is still under way"));
  EXPECT_EQ(refusal(1), "taken up");
  ASSERT_TRUE((*other)->begin_run(header_, {}));
  EXPECT_EQ(offered(), 2) << "its writer has left it";
  EXPECT_THAT(refusal(3), HasSubstr("still under way"));
  other->reset();
  EXPECT_EQ(offered(), 3) << "what holds it dies with its writer";
  EXPECT_EQ(refusal(3), "taken up");
}

TEST_F(ResumptionTest, ARunThatEndsIsHeldNoLonger) {
  auto log = record::RunLog::open(store_);
  ASSERT_TRUE((*log)->begin_run(header_, {}));
  const auto reader = record::RunLogReader::open(store_);
  EXPECT_TRUE((*reader)->being_written(1));
  EXPECT_FALSE((*reader)->being_written(2));
  ASSERT_TRUE((*log)->end_run({procedures::RunOutcome::kAborted, "aborted", true, "", {}}));
  EXPECT_FALSE((*reader)->being_written(1));
  EXPECT_THAT(offered(), 0);
}

TEST_F(ResumptionTest, ADryRunOfARealBenchHidesNothingAndIsNotOffered) {
  setup_.scenario_json.clear();
  const std::string dry = std::exchange(header_.scenario_json, "");
  interrupt();
  header_.scenario_json = dry;
  interrupt();
  EXPECT_EQ(offered(), 1);
}

TEST_F(ResumptionTest, TheGapKnowsThatTheClockWasSet) {
  interrupt();
  {
    const auto log = record::RunLog::open(store_);
    ASSERT_TRUE((*log)->begin_run(header_, {{"gyro", identity_, "SIM-FOG-1", "", ""}}));
    ASSERT_TRUE((*log)->step_started("1", "average", 0.0));
    ASSERT_TRUE((*log)->event(3.0, "warning", "set forward", R"({"clock_step_s":3600.000})"));
    ASSERT_TRUE((*log)->event(4.0, "warning", "set back", R"({"clock_step_s":-60.000})"));
    ASSERT_TRUE((*log)->event(4.0, "info", "not JSON, by clock_step_s", "clock_step_s"));
  }
  EXPECT_EQ(plan(1)->takes_up->stopped_at_s, drivers::seconds_of_utc("2026-01-01T00:00:05Z"));
  EXPECT_EQ(plan(2)->takes_up->stopped_at_s, drivers::seconds_of_utc("2026-01-01T00:59:04Z"));

  // A minute later by a clock that was right.
  header_.started_at = "2026-01-01T01:00:04Z";
  header_.continues = procedures::Continuation{.run = 2, .first_step = "1"};
  interrupt();
  const auto log = record::RunLogReader::open(store_);
  const auto points = (*log)->chain_points(3);
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 1U);
  EXPECT_DOUBLE_EQ((*points)[0].point.time_s, 4.0 + 60.0 + 2.5);
}

}  // namespace
}  // namespace fogbench::daemon
