// What a probe says of the simulated instruments, and what it must never send.

#include "drivers/probe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/bench.hpp"
#include "simulator/simulated_bench.hpp"
#include "tests/support/fake_transports.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::drivers {
namespace {

using ::testing::HasSubstr;

class Probe : public testing::Test {
 protected:
  Probe() : config_(*config::load_bench(tests::source_tree() / "config/benches/simulated.json")) {
    scenario_.noise.angle_random_walk_deg_per_sqrt_h = 0.001;
  }
  Transports connect() { return *simulator::simulate_bench(config_, scenario_, 1, clock_); }

  static const ProbeRow& row(const ProbeReport& report, const std::string& name) {
    for (const ProbeRow& r : report.rows) {
      if (r.name == name) return r;
    }
    ADD_FAILURE() << "no row " << name;
    return report.rows.front();
  }
  static void expect_no_problem(const ProbeReport& report) {
    EXPECT_FALSE(report.rows.empty());
    for (const ProbeRow& r : report.rows) EXPECT_EQ(r.problem, "") << r.name;
  }

  VirtualClock clock_;
  config::BenchConfig config_;
  config::ScenarioConfig scenario_;
};

TEST_F(Probe, ShowsEveryRegisterRawBesideScaled) {
  const Transports ends = connect();
  const ProbeReport report = probe(config_.thermostat.device, *ends.thermostat, clock_);
  expect_no_problem(report);
  EXPECT_EQ(report.rows.size(), config_.thermostat.device.registers.size());
  const ProbeRow& target = row(report, "target");
  EXPECT_EQ(target.raw, "00D2");
  EXPECT_NEAR(*target.value, 21.0, 1e-9);
  EXPECT_EQ(target.unit, "degC");
  EXPECT_EQ(target.place, "register 2, int16");
  EXPECT_EQ(row(report, "temperature_working_1").raw.substr(0, 3), "41A");  // 20 ... 22 as a float
}

TEST_F(Probe, AWrongAddressOrWordOrderHidesNoOtherRegister) {
  const Transports ends = connect();
  config::ModbusDevice wrong = config_.thermostat.device;
  wrong.registers[0].address = 7;
  wrong.registers[1].word_order = config::WordOrder::kLowFirst;
  const ProbeReport report = probe(wrong, *ends.thermostat, clock_);
  EXPECT_THAT(report.rows[0].problem, HasSubstr("exception 2"));
  EXPECT_EQ(report.rows[1].problem, "outside the limits of the description");
  EXPECT_EQ(report.rows[2].problem, "");
}

TEST_F(Probe, AsksASupplyOnlyQuestions) {
  support::FakeScpi far;
  far.answers = {{"*IDN?", "KEPCO,BOP 36-6"}, {"CURR?", "0.0"}, {"MEAS:CURR?", "oops"}};
  support::FakeMessages messages(far);
  const ProbeReport report = probe(config_.coil_vertical.device, messages);
  EXPECT_EQ(far.sent, (std::vector<std::string>{"*IDN?", "CURR?", "MEAS:CURR?", "SYST:ERR?"}));
  EXPECT_EQ(row(report, "identity").raw, "KEPCO,BOP 36-6");
  EXPECT_EQ(*row(report, "set").value, 0.0);
  EXPECT_EQ(row(report, "set").unit, "A");
  EXPECT_EQ(row(report, "measured").problem, "is no number");
  EXPECT_EQ(row(report, "measured").raw, "oops");
}

TEST_F(Probe, NeverSendsWhatIsNoSingleQuestion) {
  support::FakeScpi far;
  config::ScpiDevice device = config_.coil_vertical.device;
  device.set_query = "CURR 5;CURR?";
  device.measure_query = "*tst?";
  device.error_query = "OUTP ON";
  support::FakeMessages messages(far);
  const ProbeReport report = probe(device, messages);
  EXPECT_EQ(far.sent, std::vector<std::string>{"*IDN?"});
  EXPECT_EQ(row(report, "set").problem, "is not a single question; not sent");
  EXPECT_EQ(row(report, "identity").problem, "no answer");
}

TEST_F(Probe, ShowsAReportsBytesAndFields) {
  const Transports ends = connect();
  const ProbeReport report = probe(config_.magnetometer.device, *ends.magnetometer);
  expect_no_problem(report);
  EXPECT_EQ(row(report, "report").raw.substr(0, 2), "01");
  EXPECT_NEAR(*row(report, "field_x").value, -50.0, 1.0);
  EXPECT_EQ(row(report, "field_x").place, "bytes 1 ... 4, int32");
  scenario_.faults = {
      {"magnetometer", config::FaultKind::kTimeout, config::Seconds{0.0}, config::Seconds{1e6}}};
  const Transports silent = connect();
  EXPECT_THAT(probe(config_.magnetometer.device, *silent.magnetometer).rows[0].problem,
              HasSubstr("no report"));
}

TEST_F(Probe, ShowsTheNewestFrameAndWhatTheLineCarries) {
  const Transports ends = connect();
  const ProbeReport report = probe(config_.gyro.device, *ends.gyro, clock_);
  expect_no_problem(report);
  EXPECT_EQ(row(report, "frame").raw.substr(0, 11), "FE 81 FF 55");
  EXPECT_NEAR(*row(report, "rate_x").value, 12.4, 5.0);
  EXPECT_NEAR(*row(report, "acceleration_x").value, 1.0, 1e-6);
  ASSERT_EQ(report.notes.size(), 1U);
  EXPECT_THAT(report.notes[0], HasSubstr("; 0 missing"));
}

TEST_F(Probe, HoldsTheFrameRateAgainstTheClock) {
  const Transports ends = connect();
  const ProbeRow right = row(probe(config_.gyro.device, *ends.gyro, clock_), "frame rate");
  EXPECT_EQ(right.problem, "");
  EXPECT_NEAR(*right.value, 100.0, 0.1);
  for (const double rate_hz : {90.0, 101.0}) {
    config_.simulation.gyro_frame_rate_hz = rate_hz;
    const Transports others = connect();
    const Clock::Instant begun = clock_.now();
    const ProbeRow wrong = row(probe(config_.gyro.device, *others.gyro, clock_), "frame rate");
    EXPECT_LT(to_seconds(clock_.now() - begun), 10.0);
    EXPECT_NEAR(*wrong.value, rate_hz, 0.1);
    EXPECT_EQ(wrong.problem, "expected 100 as the description states, within 0.3 %");
  }
}

TEST_F(Probe, SaysWhenNoFrameFitsTheDescription) {
  const Transports ends = connect();
  config::FrameDevice wrong = config_.gyro.device;
  wrong.crc.polynomial ^= 2U;
  const ProbeReport report = probe(wrong, *ends.gyro, clock_);
  EXPECT_EQ(report.rows[0].problem, "no frame with this header and check value");
  EXPECT_THAT(report.notes[0], HasSubstr("0 good frames"));
}

}  // namespace
}  // namespace fogbench::drivers
