// Auxiliary sensors in a run: recorded with every point and once a second, and a fault of one is on
// record and costs nothing else, unless the procedure says that it matters.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "daemon/session.hpp"
#include "daemon/simulated_operator.hpp"
#include "tests/support/memory_recorder.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

using config::FaultKind;
using testing::HasSubstr;

const std::filesystem::path kReady = tests::source_tree() / "config";

class AuxiliaryTest : public testing::Test {
 protected:
  AuxiliaryTest()
      : setup_(*load_setup({(kReady / "benches/simulated-auxiliary.json").string(),
                            (kReady / "scenarios/pressure.json").string()})) {}

  void add_fault(const char* device, FaultKind kind, double at_s, double for_s) {
    setup_.scenario.faults.push_back({device, kind, config::Seconds{at_s}, config::Seconds{for_s}});
  }
  /// Ten averages of 30 s.
  procedures::RunSummary run(const std::filesystem::path& procedure) {
    const auto planned = plan_procedure(procedure.string(), setup_.bench,
                                        {{"duration_s", 300.0}, {"average_s", 30.0}});
    EXPECT_TRUE(planned) << planned.error().message;
    SimulatedOperator person;
    const auto session = Session::open(setup_, 3, record_, Speed::kMaximum, person);
    EXPECT_TRUE(session) << session.error().message;
    const auto summary = (*session)->run(*planned);
    EXPECT_TRUE(summary) << summary.error().message;
    return *summary;
  }
  long events_with(const std::string& text) const {
    return std::count_if(record_.events.begin(), record_.events.end(), [&](const auto& event) {
      return event.message.find(text) != std::string::npos;
    });
  }
  std::filesystem::path procedure_that_needs(const std::string& channel) {
    auto text = support::read_text(kReady / "procedures/static-record.json");
    const auto at = text.find("\"steps\"");
    return folder_.file("needs.json", text.insert(at, "\"needs\": [\"" + channel + "\"],\n  "));
  }

  const std::filesystem::path ready_ = kReady / "procedures/static-record.json";
  daemon::Setup setup_;
  test::MemoryRecorder record_;
  support::TemporaryFolder folder_;
};

TEST_F(AuxiliaryTest, EveryChannelIsInEveryPointAndEveryRow) {
  EXPECT_EQ(run(ready_).end.outcome, procedures::RunOutcome::kCompleted);
  ASSERT_EQ(record_.points.size(), 10U);
  for (const procedures::Point& point : record_.points) {
    ASSERT_EQ(point.auxiliary.size(), 5U);
    EXPECT_NEAR(point.auxiliary.at("pressure_hpa"), 1013.0, 1.0);
    EXPECT_NEAR(point.auxiliary.at("supply_v"), 5.0, 0.06);
    EXPECT_NEAR(point.auxiliary.at("humidity_percent"), 45.0, 2.0);
  }
  ASSERT_EQ(record_.headers.at(0).auxiliary.size(), 5U);
  EXPECT_EQ(record_.headers.at(0).auxiliary[0].name, "pressure_hpa");
  EXPECT_EQ(record_.headers.at(0).auxiliary[0].meaning, "air pressure in the room");
  EXPECT_TRUE(std::any_of(record_.instrument_records.begin(), record_.instrument_records.end(),
                          [](const auto& its) {
                            return its.role == "voltmeter" && its.identity == "34461A" &&
                                   its.serial_number == "SIM-VM-1";
                          }));
  EXPECT_EQ(events_with("channels are missing"), 0);
}

TEST_F(AuxiliaryTest, OneThatIsSilentCostsItsOwnChannelsAndNothingElse) {
  for (const FaultKind kind : {FaultKind::kUnplug, FaultKind::kTimeout}) {
    record_ = {};
    setup_.scenario.faults.clear();
    add_fault("barometer", kind, 95.0, 90.0);
    EXPECT_EQ(run(ready_).end.outcome, procedures::RunOutcome::kCompleted);
    ASSERT_EQ(record_.points.size(), 10U);
    EXPECT_TRUE(std::isnan(record_.points[4].auxiliary.at("pressure_hpa")));
    EXPECT_FALSE(std::isnan(record_.points[4].auxiliary.at("supply_v")));
    EXPECT_FALSE(std::isnan(record_.points[4].temperature_c));
    EXPECT_NEAR(record_.points[8].auxiliary.at("pressure_hpa"), 1013.0, 1.0);
    EXPECT_EQ(events_with("barometer: "), 2);
    EXPECT_EQ(events_with("its channels are missing until it answers, the run goes on"), 1);
    EXPECT_EQ(events_with("barometer: answers again after"), 1);
    EXPECT_EQ(events_with("begins again"), 0);
  }
}

TEST_F(AuxiliaryTest, OneThatIsMissingFromTheStartKeepsNobodyFromRunning) {
  add_fault("voltmeter", FaultKind::kUnplug, 0.0, 1e6);
  EXPECT_EQ(run(ready_).end.outcome, procedures::RunOutcome::kCompleted);
  ASSERT_EQ(record_.points.size(), 10U);
  EXPECT_TRUE(std::isnan(record_.points[9].auxiliary.at("supply_v")));
}

TEST_F(AuxiliaryTest, AProcedureMaySayThatAChannelMatters) {
  add_fault("barometer", FaultKind::kUnplug, 95.0, 40.0);
  const auto summary = run(procedure_that_needs("pressure_hpa"));
  EXPECT_EQ(summary.end.outcome, procedures::RunOutcome::kCompleted) << summary.end.reason;
  for (const procedures::Point& point : record_.points) {
    EXPECT_FALSE(std::isnan(point.auxiliary.at("pressure_hpa")));
  }
  EXPECT_GE(events_with("readings of pressure_hpa in 30 s"), 1);
}

TEST_F(AuxiliaryTest, AChannelThatNobodyMeasuresIsNotPlanned) {
  const auto planned = plan_procedure(procedure_that_needs("noise_db").string(), setup_.bench, {});
  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(planned.error().message,
              HasSubstr("needs.json: /needs: no auxiliary sensor of the bench simulated-auxiliary "
                        "measures \"noise_db\""));
}

TEST_F(AuxiliaryTest, AnInterlockWatchesAChannel) {
  for (config::InterlockConfig& interlock : setup_.bench.interlocks) {
    if (interlock.name != "supply") continue;
    interlock.action = config::InterlockAction::kAbort;
    interlock.all_of[0].trip = 4.99;
    interlock.all_of[0].clear = 4.995;
  }
  auto& voltmeter = std::get<config::ScpiSensor>(setup_.bench.auxiliary[1].device);
  voltmeter.channels[0].simulated = {5.0, -0.05, config::Seconds{600.0}, 0.0003};
  const auto summary = run(ready_);
  EXPECT_EQ(summary.end.outcome, procedures::RunOutcome::kFailed);
  EXPECT_THAT(summary.end.reason, HasSubstr("interlock supply: supply_v: reads 4.9"));
  EXPECT_THAT(summary.end.reason, HasSubstr("V (trips below 4.99, clears at 4.995)"));
  EXPECT_TRUE(summary.end.safe_state_reached);
}

TEST_F(AuxiliaryTest, AnEffectOfWhatNobodyMeasuresCannotBeSimulated) {
  setup_.scenario.hidden[0].effect = "sensitivity(noise_db)";
  SimulatedOperator person;
  const auto session = Session::open(setup_, 3, record_, Speed::kMaximum, person);
  ASSERT_FALSE(session);
  EXPECT_THAT(
      session.error().message,
      HasSubstr("scenario: /hidden/0: sensitivity(noise_db): no auxiliary sensor of the bench "
                "simulated-auxiliary measures noise_db"));
}

}  // namespace
}  // namespace fogbench::daemon
