// The magnetometer at its reports.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>

#include "tests/simulator/test_bench.hpp"

namespace fogbench::simulator {
namespace {

using config::FaultKind;
using namespace std::chrono_literals;

using Report = std::array<std::uint8_t, 16>;

Result<Report> read(TestFarEnds& bench) {
  Report report{};
  const Result<std::size_t> length = bench.ends.magnetometer->read_report(report, 1s);
  if (!length) return length.error();
  EXPECT_EQ(*length, report.size());
  return report;
}

double field(const Report& report, std::size_t axis) {
  std::int32_t raw = 0;
  std::memcpy(&raw, report.data() + 1 + 4 * axis, sizeof raw);
  return raw * 1e-4;
}

TEST(HidFarEnd, ReportsTheFieldInGyroAxesWithMatrixOffsetAndNoise) {
  config::BenchConfig config = test_bench();
  config.simulation.magnetic.ambient_diurnal = config::Microtesla{0.0};
  config.simulation.magnetic.sensor_noise = config::Microtesla{0.01};
  config.simulation.magnetic.sensor_offset_ut = {0.5, 0.0, -0.25};
  config.simulation.magnetic.sensor_matrix = {{{1.01, 0.0, 0.0}, {0.0, 0.99, 0.02}, {0, 0, 1}}};
  TestFarEnds bench(config);
  constexpr int kReports = 2000;
  double sum[3] = {};
  double squares = 0.0;
  for (int i = 0; i < kReports; ++i) {
    const Report report = *read(bench);
    EXPECT_EQ(report[0], 7);
    for (std::size_t k = 0; k < 3; ++k) sum[k] += field(report, k) / kReports;
    squares += std::pow(field(report, 0) - (-50.0 * 1.01 + 0.5), 2) / kReports;
  }
  const double error = 5.0 * 0.01 / std::sqrt(kReports);  // Five standard errors.
  EXPECT_NEAR(sum[0], -50.0 * 1.01 + 0.5, error);
  EXPECT_NEAR(sum[1], 16.0 * 0.99 - 0.02, error);
  EXPECT_NEAR(sum[2], -1.0 - 0.25, error);
  EXPECT_NEAR(std::sqrt(squares), 0.01, 5.0 * 0.01 / std::sqrt(2.0 * kReports));
}

TEST(HidFarEnd, SendsAReportEachPeriodWithACountThatWraps) {
  TestFarEnds bench;
  for (int i = 1; i <= 600; ++i) {
    const Report report = *read(bench);
    ASSERT_EQ(report[13], i % 256);
    ASSERT_EQ(bench.clock.now().time_since_epoch(), i * 100ms);
  }
  bench.run_for(10.05);  // Only the newest report waits.
  EXPECT_EQ((*read(bench))[13], 700 % 256);
  EXPECT_EQ(bench.clock.now().time_since_epoch(), 70050ms);
}

TEST(HidFarEnd, WhatAReportShowsDoesNotDependOnWhichWereRead) {
  TestFarEnds eager;
  TestFarEnds lazy;
  Report last{};
  for (int i = 0; i < 50; ++i) last = *read(eager);
  lazy.run_for(5.0);
  EXPECT_EQ(*read(lazy), last);
}

TEST(HidFarEnd, WaitsNoLongerThanItsTimeOut) {
  TestFarEnds bench;
  Report report{};
  const auto early = bench.ends.magnetometer->read_report(report, 30ms);
  ASSERT_FALSE(early);
  EXPECT_EQ(early.error().code, ErrorCode::kTimeout);
  EXPECT_EQ(bench.clock.now().time_since_epoch(), 30ms);
}

TEST(HidFarEnd, SaturatesAtItsRange) {
  config::BenchConfig config = test_bench();
  config.magnetometer.device.range = config::Microtesla{40.0};
  TestFarEnds bench(config);
  EXPECT_DOUBLE_EQ(field(*read(bench), 0), -40.0);
}

TEST(HidFarEnd, RefusesReportsThatMakeNoSense) {
  TestFarEnds bench;
  std::array<std::uint8_t, 15> small{};
  const auto result = bench.ends.magnetometer->read_report(small, 1s);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kProtocol);
  EXPECT_FALSE(bench.ends.magnetometer->write_report({}));
  EXPECT_TRUE(bench.ends.magnetometer->write_report(small));
}

TEST(HidFarEnd, FailsInTheWaysOfTheScenario) {
  config::ScenarioConfig scenario;
  scenario.faults = {fault("magnetometer", FaultKind::kTimeout, 10.0, 5.0),
                     fault("magnetometer", FaultKind::kUnplug, 20.0, 5.0),
                     fault("magnetometer", FaultKind::kStuck, 30.0, 5.0),
                     fault("magnetometer", FaultKind::kNan, 40.0, 5.0),
                     fault("magnetometer", FaultKind::kBadSequence, 50.0, 5.0),
                     fault("magnetometer", FaultKind::kGarbage, 60.0, 5.0),
                     fault("magnetometer", FaultKind::kLateAnswer, 80.0, 5.0),
                     fault("magnetometer", FaultKind::kSlowAnswer, 90.0, 5.0)};
  TestFarEnds bench(test_bench(), scenario);
  const auto at = [&](double time_s) {
    bench.clock.sleep_until(drivers::Clock::Instant{drivers::from_seconds(time_s)});
    return read(bench);
  };
  EXPECT_TRUE(at(9.0));
  EXPECT_EQ(at(11.0).error().code, ErrorCode::kTimeout);
  EXPECT_EQ(bench.clock.now().time_since_epoch(), 12s);
  EXPECT_EQ(at(21.0).error().code, ErrorCode::kUnplugged);
  EXPECT_FALSE(bench.ends.magnetometer->write_report(Report{}));
  const Report before = *at(29.0);
  for (const double stuck_at_s : {31.0, 34.0}) {
    const Report stuck = *at(stuck_at_s);
    EXPECT_TRUE(std::equal(stuck.begin(), stuck.begin() + 13, before.begin()));
    EXPECT_NE(stuck[13], before[13]) << "the count goes on";
  }
  EXPECT_EQ((*at(41.0))[4], 0x80);  // The most negative number: no reading.
  EXPECT_EQ((*at(51.0))[13], 510 / 2 % 256);
  EXPECT_NE((*at(61.0))[0], 7);
  EXPECT_NEAR(field(*at(70.0), 0), -50.0, 0.1);
  EXPECT_EQ(at(81.0).error().code, ErrorCode::kTimeout);
  EXPECT_EQ(bench.clock.now().time_since_epoch(), 82s);
  EXPECT_TRUE(at(90.0)) << "just under the deadline";
  EXPECT_EQ(bench.clock.now().time_since_epoch(), 90900ms);
}

TEST(HidFarEnd, SaysInItsStatusThatSomethingIsWrong) {
  config::BenchConfig config = test_bench();
  config::FieldSpec status;
  status.name = "status";
  status.offset_bytes = 14;
  status.type = config::NumberType::kUint8;
  config.magnetometer.device.fields.push_back(status);
  config::ScenarioConfig scenario;
  scenario.faults = {fault("magnetometer", FaultKind::kException, 10.0, 5.0)};
  TestFarEnds bench(config, scenario);
  bench.run_for(9.0);
  EXPECT_EQ((*read(bench))[14], 0);
  bench.run_for(2.0);
  EXPECT_EQ((*read(bench))[14], 1);
}

}  // namespace
}  // namespace fogbench::simulator
