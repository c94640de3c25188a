// The interlocks by themselves: a row of observations in, what trips and clears out.

#include "procedures/interlocks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace fogbench::procedures {
namespace {

using config::Ampere;
using config::Celsius;
using config::InterlockAction;
using config::InterlockCondition;
using config::InterlockConfig;
using config::InterlockKind;
using config::Microtesla;
using ::testing::HasSubstr;

const double kMissing = std::numeric_limits<double>::quiet_NaN();

InterlockCondition on(InterlockKind kind, double trip, double clear) {
  return {.kind = kind, .trip = trip, .clear = clear};
}
InterlockCondition hot() {
  return on(InterlockKind::kOverTemperature, 60.0, 58.0);
}
InterlockCondition silent() {
  return on(InterlockKind::kGyroSilent, 5.0, 1.0);
}
InterlockConfig all_of(std::vector<InterlockCondition> conditions, std::uint16_t consecutive) {
  return {"i", std::move(conditions), {}, consecutive, InterlockAction::kAbort};
}
InterlockConfig any_of(std::vector<InterlockCondition> conditions, std::uint16_t consecutive) {
  return {"i", {}, std::move(conditions), consecutive, InterlockAction::kAbort};
}

/// A bench on which all is well.
Observation well() {
  Observation seen;
  seen.row.thermostat.working_1 = seen.row.thermostat.working_2 = Celsius{31.0};
  seen.row.thermostat.control = Celsius{31.0};
  seen.stream.frames_good = 1000;
  return seen;
}
Observation at_c(double working_1_c, double silent_s = 0.0) {
  Observation seen = well();
  seen.row.thermostat.working_1 = Celsius{working_1_c};
  seen.gyro_silent_s = silent_s;
  return seen;
}

/// One letter a second: T trips, C clears, . nothing.
class Watched {
 public:
  explicit Watched(const InterlockConfig& interlock) { bench_.interlocks = {interlock}; }

  std::string after(const std::vector<Observation>& seconds) {
    Interlocks interlocks(bench_);
    std::string letters;
    for (const Observation& seen : seconds) {
      const auto changes = interlocks.observe(seen);
      letters += changes.empty() ? '.' : (changes[0].tripped ? 'T' : 'C');
      EXPECT_EQ(interlocks.tripped().size(), tripped(letters) ? 1U : 0U) << letters;
    }
    return letters;
  }
  std::string after_c(const std::vector<double>& temperatures_c) {
    std::vector<Observation> seconds;
    for (const double t : temperatures_c) seconds.push_back(at_c(t));
    return after(seconds);
  }
  config::BenchConfig& bench() { return bench_; }

 private:
  static bool tripped(const std::string& letters) {
    const auto last = letters.find_last_of("TC");
    return last != std::string::npos && letters[last] == 'T';
  }
  config::BenchConfig bench_;
};

TEST(Interlocks, TripAfterSoManyInARowAndStayTripped) {
  EXPECT_EQ(Watched(all_of({hot()}, 3)).after_c({61, 61, 61, 61, 61}), "..T..");
  EXPECT_EQ(Watched(all_of({hot()}, 1)).after_c({31, 61, 61}), ".T.");
  EXPECT_EQ(Watched(all_of({hot()}, 1)).after_c({60}), ".") << "the threshold itself is allowed";
}

TEST(Interlocks, AGoodSecondBreaksTheRowEvenBetweenTheThresholds) {
  EXPECT_EQ(Watched(all_of({hot()}, 3)).after_c({61, 61, 31, 61, 61, 61}), ".....T");
  EXPECT_EQ(Watched(all_of({hot()}, 3)).after_c({61, 61, 59, 61, 61, 61}), ".....T");
}

TEST(Interlocks, ClearAtTheClearThresholdAndNotBetween) {
  EXPECT_EQ(Watched(all_of({hot()}, 2)).after_c({61, 61, 59, 58.1, 58, 59, 61, 61}), ".T..C..T");
}

TEST(Interlocks, MissingReadingsNeitherTripNorClearNorBreakTheRow) {
  EXPECT_EQ(Watched(all_of({hot()}, 2)).after_c({kMissing, kMissing, kMissing}), "...");
  EXPECT_EQ(Watched(all_of({hot()}, 2)).after_c({61, kMissing, 61, kMissing, 31}), "..T.C");
}

TEST(Interlocks, AllOfTripsWhenAllHoldAndClearsWithTheFirstThatIsOver) {
  Watched both(all_of({hot(), silent()}, 1));
  EXPECT_EQ(both.after({at_c(61, 0), at_c(31, 9), at_c(61, 9), at_c(59, 3), at_c(59, 0)}), "..T.C");
  EXPECT_EQ(both.after({at_c(61, 9), at_c(kMissing, 9), at_c(kMissing, 0)}), "T.C")
      << "one that is over decides whatever is missing";
}

TEST(Interlocks, AnyOfTripsWithTheFirstAndClearsWhenAllAreOver) {
  Watched either(any_of({hot(), silent()}, 1));
  EXPECT_EQ(either.after({at_c(61, 0), at_c(31, 9), at_c(31, 3), at_c(31, 0)}), "T..C");
  EXPECT_EQ(either.after({at_c(kMissing, 9), at_c(kMissing, 0), at_c(31, 0)}), "T.C")
      << "what is missing may still hold";
}

TEST(Interlocks, AreUndecidedWhileARowIsShorterThanItTakes) {
  config::BenchConfig bench;
  bench.interlocks = {all_of({hot()}, 2)};
  Interlocks interlocks(bench);
  EXPECT_FALSE(interlocks.undecided());
  interlocks.observe(at_c(61));
  EXPECT_TRUE(interlocks.undecided());
  interlocks.observe(at_c(61));
  EXPECT_FALSE(interlocks.undecided());
}

TEST(Interlocks, TellWhatTheySawAndWhatIsAllowed) {
  config::BenchConfig bench;
  bench.interlocks = {all_of({hot()}, 2)};
  bench.interlocks[0].name = "over-temperature";
  Interlocks interlocks(bench);
  interlocks.observe(at_c(61));
  const auto changes = interlocks.observe(at_c(61.5));
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].message,
            "interlock over-temperature: working_1: temperature is 61.5 degC (trips above 60, "
            "clears at 58), 2 in a row");
  EXPECT_EQ(changes[0].action, InterlockAction::kAbort);
  const auto data = nlohmann::json::parse(changes[0].data_json);
  EXPECT_EQ(data["interlock"], "over-temperature");
  EXPECT_EQ(data["state"], "tripped");
  EXPECT_EQ(data["action"], "abort");
  EXPECT_EQ(data["in_a_row"], 2);
  EXPECT_EQ(data["conditions"][0], (nlohmann::json{{"kind", "over_temperature"},
                                                   {"where", "working_1"},
                                                   {"value", 61.5},
                                                   {"trip", 60.0},
                                                   {"clear", 58.0},
                                                   {"unit", "degC"}}));
  EXPECT_TRUE(interlocks.tripped(InterlockAction::kPause).empty());
  ASSERT_EQ(interlocks.tripped(InterlockAction::kAbort).size(), 1U);
  interlocks.observe(at_c(59));
  EXPECT_THAT(interlocks.tripped().at(0), HasSubstr("is 59 degC")) << "as it is now";
}

GaugeReading measured(InterlockKind kind, const Observation& seen) {
  return InterlockGauge(on(kind, 1.0, 0.0), {}).measure(seen);
}

TEST(InterlockGauge, TakesTheWorstOfWhatItLooksAt) {
  Observation seen = well();
  seen.row.thermostat.working_2 = Celsius{33.0};
  seen.row.thermostat.control = Celsius{30.0};
  EXPECT_EQ(measured(InterlockKind::kOverTemperature, seen).value, 33.0);
  EXPECT_EQ(measured(InterlockKind::kSensorDisagreement, seen).value, 3.0);
  EXPECT_EQ(measured(InterlockKind::kSensorDisagreement, seen).where, "working_2");
  seen.commanded.vertical = Ampere{2.0};
  seen.row.current_vertical_a = 1.5;
  EXPECT_EQ(measured(InterlockKind::kCurrentMismatch, seen).value, 0.5);
  EXPECT_EQ(measured(InterlockKind::kCurrentMismatch, seen).where, "coil_vertical");
  seen.row.current_horizontal_a = kMissing;
  EXPECT_TRUE(std::isnan(measured(InterlockKind::kCurrentMismatch, seen).value));
}

TEST(InterlockGauge, ComparesTheFieldAlongTheCoilsAtAnyAzimuthOnceItIsKnown) {
  Observation seen = well();
  seen.row.azimuth_deg = 90.0;  // Z points north
  seen.row.field.field = {Microtesla{101.0}, Microtesla{77.0}, Microtesla{-150.0}};
  EXPECT_TRUE(std::isnan(measured(InterlockKind::kFieldMismatch, seen).value));
  seen.commanded.field_ut = {100.0, -200.0};
  EXPECT_NEAR(measured(InterlockKind::kFieldMismatch, seen).value, 50.0, 1e-9);
  EXPECT_EQ(measured(InterlockKind::kFieldMismatch, seen).where, "north");
}

TEST(InterlockGauge, CountsTheInvalidFramesSinceTheLastLook) {
  InterlockGauge gauge(on(InterlockKind::kGyroInvalid, 20.0, 1.0), {});
  Observation seen = well();
  seen.stream.frames_invalid = 500;  // from before
  EXPECT_TRUE(std::isnan(gauge.measure(seen).value));
  seen.stream.frames_good += 75;
  seen.stream.frames_invalid += 25;
  EXPECT_DOUBLE_EQ(gauge.measure(seen).value, 25.0);
  EXPECT_TRUE(std::isnan(gauge.measure(seen).value)) << "silence is not invalid";
}

TEST(InterlockGauge, TheLongestOverdueCalibrationCounts) {
  using namespace std::chrono;  // NOLINT(google-build-using-namespace)
  config::BenchConfig bench;
  Observation seen = well();
  seen.today = sys_days{2026y / November / 22};
  const auto overdue = [&] {
    return InterlockGauge(on(InterlockKind::kCalibrationOverdue, 0.0, 0.0), calibrations_of(bench))
        .measure(seen);
  };
  EXPECT_TRUE(std::isnan(overdue().value)) << "nobody says when it is due";
  bench.thermostat.calibration_due = "2027-01-15";
  bench.magnetometer.calibration_due = "2026-11-22";
  EXPECT_EQ(overdue().value, 0.0) << "valid on its last day";
  bench.coil_vertical.calibration_due = "2026-11-12";
  EXPECT_EQ(overdue().value, 10.0);
  EXPECT_EQ(overdue().where, "coil_vertical");
}

/// Seconds that the heating counts as without effect, at the end of these (time, degC).
double stalled_s(std::optional<double> target_c,
                 const std::vector<std::pair<double, double>>& course) {
  InterlockGauge gauge(on(InterlockKind::kHeaterWithoutEffect, 900.0, 60.0), {});
  double stalled = kMissing;
  for (const auto& [time_s, carrier_c] : course) {
    Observation seen = well();
    seen.row.time_s = time_s;
    seen.row.thermostat.working_1 = seen.row.thermostat.working_2 = Celsius{carrier_c};
    if (target_c) seen.commanded.target = Celsius{*target_c};
    stalled = gauge.measure(seen).value;
  }
  return stalled;
}

TEST(InterlockGauge, HeatingWithoutEffectCountsFromTheLastRise) {
  EXPECT_EQ(stalled_s(31.0, {{10, 21.0}, {300, 21.4}, {700, 21.4}}), 690.0);
  EXPECT_EQ(stalled_s(31.0, {{10, 21.0}, {300, 21.5}, {700, 21.6}}), 400.0) << "0.5 degC at 300 s";
  EXPECT_EQ(stalled_s(31.0, {{10, 29.0}, {700, 29.1}}), 0.0) << "near the target";
  EXPECT_EQ(stalled_s(31.0, {{10, 45.0}, {700, 45.0}}), 0.0) << "cooling";
  EXPECT_EQ(stalled_s(std::nullopt, {{10, 21.0}, {700, 21.0}}), 0.0) << "off";
  EXPECT_TRUE(std::isnan(stalled_s(31.0, {{10, 21.0}, {700, kMissing}})));
  EXPECT_EQ(stalled_s(31.0, {{10, 21.0}, {300, kMissing}, {700, 21.0}}), 690.0);
}

}  // namespace
}  // namespace fogbench::procedures
