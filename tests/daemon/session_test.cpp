#include "daemon/session.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "daemon/simulated_operator.hpp"
#include "tests/support/memory_recorder.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

TEST(PlanProcedure, RecordsAFileWhoseNameIsNotText) {
  const auto ready = tests::source_tree() / "config";
  const auto bench = config::load_bench(ready / "benches/simulated.json");
  ASSERT_TRUE(bench) << bench.error().message;
  const support::TemporaryFolder folder;
  const std::string text = support::read_text(ready / "procedures/coil-sweep.json");
  const auto file = folder.file(
      "proc\xe9"
      "dure.json",
      text);  // Latin-1
  const auto planned = plan_procedure(file.string(), *bench, {});
  ASSERT_TRUE(planned) << planned.error().message;
  const auto record = nlohmann::json::parse(planned->procedure_json, nullptr, false);
  ASSERT_TRUE(record.is_object());
  EXPECT_EQ(record["files"].begin().value(), text);
}

TEST(PlanProcedure, TellsAnEditedCopyFromTheReadyOneOfItsName) {
  const auto ready = tests::source_tree() / "config";
  const auto bench = config::load_bench(ready / "benches/simulated.json");
  ASSERT_TRUE(bench) << bench.error().message;
  const support::TemporaryFolder folder;
  const std::string text = support::read_text(ready / "procedures/coil-sweep.json");
  std::string edited = text;
  edited.replace(edited.find("180"), 3, "200");
  const auto name = [&](const std::filesystem::path& file) {
    const auto planned = plan_procedure(file.string(), *bench, {});
    return planned ? planned->plan.procedure : planned.error().message;
  };
  EXPECT_EQ(name(ready / "procedures/coil-sweep.json"), "coil-sweep");
  EXPECT_EQ(name(folder.file("same.json", text)), "coil-sweep");
  EXPECT_EQ(name(folder.file("coil-sweep.json", edited)),
            "coil-sweep (coil-sweep.json, not the ready one)");
  EXPECT_EQ(name(folder.file("m\xe9.json", edited)), "coil-sweep (m?.json, not the ready one)");
  edited.replace(edited.find("\"coil-sweep\""), 12, "\"my-sweep\"");
  EXPECT_EQ(name(folder.file("mine.json", edited)), "my-sweep") << "nobody takes it for another";
}

TEST(Session, AGyroOfAnotherFrameRateThanItsFileStatesEndsTheRunWithinSeconds) {
  const auto ready = tests::source_tree() / "config";
  for (const double rate_hz : {90.0, 101.0}) {
    auto setup = load_setup(
        {(ready / "benches/simulated.json").string(), (ready / "scenarios/clean.json").string()});
    ASSERT_TRUE(setup) << setup.error().message;
    setup->bench.simulation.gyro_frame_rate_hz = rate_hz;
    const auto planned = plan_procedure((ready / "procedures/static-record.json").string(),
                                        setup->bench, {{"duration_s", 600.0}});
    ASSERT_TRUE(planned) << planned.error().message;
    test::MemoryRecorder record;
    SimulatedOperator person;
    const auto session = Session::open(std::move(*setup), 3, record, Speed::kMaximum, person);
    ASSERT_TRUE(session) << session.error().message;
    const auto begun = (*session)->clock().now();
    const auto summary = (*session)->run(*planned);
    ASSERT_TRUE(summary) << summary.error().message;
    EXPECT_EQ(summary->end.outcome, procedures::RunOutcome::kFailed);
    EXPECT_TRUE(summary->end.safe_state_reached);
    const std::string says = fmt::format(
        "gyro: sends {:.1f} frames a second by this machine's clock, expected 100", rate_hz);
    EXPECT_NE(summary->end.reason.find(says), std::string::npos) << summary->end.reason;
    EXPECT_LT(drivers::to_seconds((*session)->clock().now() - begun), 12.0);
    EXPECT_TRUE(record.points.empty());
  }
}

TEST(Session, RecordsIntoWhatItsCallerKeeps) {
  const auto ready = tests::source_tree() / "config";
  auto setup = load_setup(
      {(ready / "benches/simulated.json").string(), (ready / "scenarios/clean.json").string()});
  ASSERT_TRUE(setup) << setup.error().message;
  auto planned = plan_procedure((ready / "procedures/static-record.json").string(), setup->bench,
                                {{"duration_s", 10.0}, {"average_s", 5.0}});
  ASSERT_TRUE(planned) << planned.error().message;
  EXPECT_EQ(planned->gyro, "SIM-FOG-1");
  planned->gyro = "FOG-42";
  test::MemoryRecorder record;
  SimulatedOperator person;
  const auto session = Session::open(std::move(*setup), 3, record, Speed::kMaximum, person);
  ASSERT_TRUE(session) << session.error().message;
  const auto summary = (*session)->run(*planned);
  ASSERT_TRUE(summary) << summary.error().message;
  EXPECT_EQ(summary->end.outcome, procedures::RunOutcome::kCompleted);
  EXPECT_FALSE(record.points.empty());
  EXPECT_EQ(record.headers.at(0).seed, 3U);
  EXPECT_EQ(record.headers.at(0).gyro_serial_number, "FOG-42");
  for (const procedures::InstrumentRecord& instrument : record.instrument_records) {
    EXPECT_EQ(instrument.serial_number == "FOG-42", instrument.role == "gyro") << instrument.role;
  }
  EXPECT_EQ(record.instrument_records.size(), 6U);
}

TEST(Session, EachRunsDatesFollowTheMachinesClockAtItsStart) {
  const auto ready = tests::source_tree() / "config";
  auto setup = load_setup(
      {(ready / "benches/simulated.json").string(), (ready / "scenarios/clean.json").string()});
  ASSERT_TRUE(setup) << setup.error().message;
  const auto planned = plan_procedure((ready / "procedures/static-record.json").string(),
                                      setup->bench, {{"duration_s", 10.0}, {"average_s", 5.0}});
  ASSERT_TRUE(planned) << planned.error().message;
  test::MemoryRecorder record;
  SimulatedOperator person;
  const auto session = Session::open(std::move(*setup), 3, record, Speed::kMaximum, person);
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE((*session)->run(*planned));
  auto* clock = dynamic_cast<drivers::VirtualClock*>(&(*session)->clock());
  ASSERT_NE(clock, nullptr);
  clock->set_calendar(-std::chrono::hours{24});  // between two runs
  ASSERT_TRUE((*session)->run(*planned));
  ASSERT_EQ(record.headers.size(), 2U);
  const double apart_s = drivers::seconds_of_utc(record.headers[1].started_at) -
                         drivers::seconds_of_utc(record.headers[0].started_at);
  EXPECT_GT(apart_s, -86400.0);
  EXPECT_LT(apart_s, -82800.0);
  EXPECT_FALSE(record.has_event("clock")) << "neither run saw it";
}

TEST(Session, ABenchIsSimulatedOrRealAsAWhole) {
  const auto ready = tests::source_tree() / "config/benches";
  auto simulated = config::load_bench(ready / "simulated.json");
  auto real = config::load_bench(ready / "factory.json");
  ASSERT_TRUE(simulated && real);
  EXPECT_TRUE(*is_simulated(*simulated));
  EXPECT_FALSE(*is_simulated(*real)) << "the turntable that is turned by hand does not count";

  simulated->turntable.connection = "tty:/dev/ttyUSB0";
  const auto mixed = is_simulated(*simulated);
  ASSERT_FALSE(mixed);
  EXPECT_EQ(mixed.error().code, ErrorCode::kBadInput);
  EXPECT_NE(mixed.error().message.find("/turntable/connection is not; expected all"),
            std::string::npos)
      << mixed.error().message;
  real->gyro.connection = "simulated";
  EXPECT_NE(is_simulated(*real).error().message.find("/gyro/connection is \"simulated\""),
            std::string::npos);
}

}  // namespace
}  // namespace fogbench::daemon
