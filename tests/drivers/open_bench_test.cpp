// The drivers on the far ends of the simulated bench, with the instruments of config/devices: both
// read the same descriptions, so a misreading shows as a disagreement.

#include "drivers/open_bench.hpp"

#include <gtest/gtest.h>

#include "config/device_file.hpp"
#include "config/scenario.hpp"
#include "simulator/simulated_bench.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;
using config::FaultKind;

class NobodyThere final : public Operator {
 public:
  Result<bool> confirm(const std::string&) override { return false; }
};

class OpenBenchTest : public testing::Test {
 protected:
  OpenBenchTest()
      : config_(*config::load_bench(tests::source_tree() / "config/benches/simulated.json")) {
    // Little enough for one frame to show the rate, and never the same twice.
    scenario_.noise.angle_random_walk_deg_per_sqrt_h = 1e-4;
  }

  void use(const std::string& device) {
    const auto file =
        *config::load_device(tests::source_tree() / "config/devices" / (device + ".json"));
    if (const auto* modbus = std::get_if<config::ModbusDevice>(&file)) {
      config_.thermostat.device = *modbus;
    } else if (const auto* frames = std::get_if<config::FrameDevice>(&file)) {
      config_.gyro.device = *frames;
    }
  }
  void add_fault(const std::string& device, FaultKind kind, double at_s) {
    scenario_.faults.push_back({device, kind, config::Seconds{at_s}, config::Seconds{1e6}});
  }
  Transports connect() {
    auto ends = simulator::simulate_bench(config_, scenario_, 1, clock_);
    EXPECT_TRUE(ends) << ends.error().message;
    return std::move(*ends);
  }
  Result<Bench> open() { return open_bench(config_, connect(), clock_, nobody_); }

  VirtualClock clock_;
  config::BenchConfig config_;
  config::ScenarioConfig scenario_;
  NobodyThere nobody_;
};

TEST_F(OpenBenchTest, EveryInstrumentAnswersAndTheCoilsAreSafe) {
  const auto bench = open();
  ASSERT_TRUE(bench) << bench.error().message;
  for (CoilSupply* coil : {bench->coil_horizontal.get(), bench->coil_vertical.get()}) {
    const auto current = coil->read();
    ASSERT_TRUE(current) << current.error().message;
    EXPECT_EQ(current->set, Ampere{0.0});
    EXPECT_NEAR(current->measured.value, 0.0, 0.005);
  }
  for (Instrument* instrument : {static_cast<Instrument*>(bench->thermostat.get()),
                                 static_cast<Instrument*>(bench->coil_horizontal.get()),
                                 static_cast<Instrument*>(bench->coil_vertical.get()),
                                 static_cast<Instrument*>(bench->magnetometer.get()),
                                 static_cast<Instrument*>(bench->turntable.get()),
                                 static_cast<Instrument*>(bench->gyro.get())}) {
    const auto identity = instrument->identity();
    ASSERT_TRUE(identity);
    EXPECT_FALSE(identity->empty());
  }
}

TEST_F(OpenBenchTest, EveryThermostatOfTheConfigurationHeats) {
  for (const char* device : {"thermostat-eurotherm", "thermostat-omron", "thermostat-watlow"}) {
    use(device);
    const auto bench = open();
    ASSERT_TRUE(bench) << device << ": " << bench.error().message;
    ASSERT_TRUE(bench->thermostat->set_target(Celsius{35.0}));
    ASSERT_TRUE(bench->thermostat->set_mode(HeatingMode::kBoost));
    clock_.sleep_for(60s);
    const auto reading = bench->thermostat->read();
    ASSERT_TRUE(reading) << device << ": " << reading.error().message;
    EXPECT_EQ(reading->mode, HeatingMode::kBoost) << device;
    EXPECT_NEAR(reading->target.value, 35.0, 1e-3) << device;
    EXPECT_NEAR(reading->boost_power.value, 12.0, 0.1) << device;
    EXPECT_NEAR(reading->ambient.value, 21.0, 1.0) << device;
    EXPECT_GT(reading->working_1.value, 20.0) << device;
    EXPECT_LT(reading->working_1.value, 36.0) << device;
  }
}

TEST_F(OpenBenchTest, EveryGyroOfTheConfigurationStreamsWithoutLoss) {
  for (const char* device : {"gyro-kvh", "gyro-crc8"}) {
    use(device);
    const auto bench = open();
    ASSERT_TRUE(bench) << device << ": " << bench.error().message;
    GyroBlock block;
    for (int second = 0; second < 30; ++second) {
      clock_.sleep_for(1s);
      ASSERT_TRUE(bench->gyro->read(block));
    }
    EXPECT_NEAR(static_cast<double>(block.index.size()), 30.0 * bench->gyro->frame_rate_hz(), 2.0);
    EXPECT_EQ(block.index.back() - block.index.front() + 1,
              static_cast<std::int64_t>(block.index.size()));
    EXPECT_NEAR(block.rate_deg_per_h.back(), 12.433, 2.0) << device;
    EXPECT_EQ(bench->gyro->statistics().bytes_skipped, 0u);
  }
}

TEST_F(OpenBenchTest, TheMagnetometerSeesTheCoilsAndTurnsWithTheTable) {
  const auto bench = open();
  ASSERT_TRUE(bench) << bench.error().message;
  const auto before = bench->magnetometer->read();
  ASSERT_TRUE(before);
  ASSERT_TRUE(bench->coil_horizontal->enable());
  ASSERT_TRUE(bench->coil_horizontal->set_current(Ampere{2.0}));
  clock_.sleep_for(1s);
  const auto with_current = bench->magnetometer->read();
  ASSERT_TRUE(with_current);
  EXPECT_NEAR(with_current->field[0].value - before->field[0].value, 2.0 * 89.6, 1.0);
  ASSERT_TRUE(bench->turntable->rotate_to(Degree{90.0}));
  EXPECT_NEAR(bench->turntable->azimuth()->value, 90.0, 0.05);
  clock_.sleep_for(1s);
  const auto turned = bench->magnetometer->read();
  ASSERT_TRUE(turned);
  EXPECT_NEAR(std::abs(turned->field[2].value), 16.0, 2.0);  // what points north now is z
}

TEST_F(OpenBenchTest, NamesTheInstrumentThatCannotBeOpened) {
  for (const char* device :
       {"thermostat", "coil_horizontal", "coil_vertical", "magnetometer", "turntable", "gyro"}) {
    scenario_.faults.clear();
    add_fault(device, FaultKind::kUnplug, 0.0);
    const auto bench = open();
    ASSERT_FALSE(bench) << device;
    EXPECT_TRUE(bench.error().message.starts_with(std::string(device) + ": "))
        << bench.error().message;
  }
}

TEST_F(OpenBenchTest, AnInstrumentWithoutATransportIsADeviceError) {
  const auto without = [&](auto Transports::*member) {
    Transports transports = connect();
    (transports.*member).reset();
    const auto bench = open_bench(config_, std::move(transports), clock_, nobody_);
    return bench ? std::string("opened") : bench.error().message;
  };
  EXPECT_EQ(without(&Transports::thermostat), "thermostat: is not connected to anything");
  EXPECT_EQ(without(&Transports::coil_horizontal), "coil_horizontal: is not connected to anything");
  EXPECT_EQ(without(&Transports::coil_vertical), "coil_vertical: is not connected to anything");
  EXPECT_EQ(without(&Transports::magnetometer), "magnetometer: is not connected to anything");
  EXPECT_EQ(without(&Transports::turntable), "turntable: is not connected to anything");
  EXPECT_EQ(without(&Transports::gyro), "gyro: is not connected to anything");
}

TEST_F(OpenBenchTest, ATurntableOfTheOperatorsHandNeedsNoTransport) {
  Transports transports = connect();
  transports.turntable.reset();
  config_.turntable.motorised = false;
  config_.turntable.device.reset();
  const auto bench = open_bench(config_, std::move(transports), clock_, nobody_);
  ASSERT_TRUE(bench) << bench.error().message;
  EXPECT_EQ(bench->turntable->rotate_to(Degree{90.0}).error().code, ErrorCode::kAborted);
}

TEST_F(OpenBenchTest, TheIndexStaysWithTheClockThroughASilenceOfWholeTurns) {
  // At 100 Hz, 5.12 s are four turns of the sequence number: it goes on as if nothing was lost.
  scenario_.faults = {{"gyro", FaultKind::kTimeout, config::Seconds{20.0}, config::Seconds{5.12}}};
  const auto bench = open();
  ASSERT_TRUE(bench) << bench.error().message;
  GyroBlock block;
  for (int second = 0; second < 60; ++second) {
    clock_.sleep_for(1s);
    (void)bench->gyro->read(block);
  }
  const Clock::Duration age = clock_.now() - bench->gyro->time_of(block.index.back());
  EXPECT_NEAR(to_seconds(age), 0.01, 0.01);
  EXPECT_EQ(bench->gyro->statistics().frames_missing, 512u);
}

/// What each fault of an instrument shows as, a minute into a run.
TEST_F(OpenBenchTest, EveryFaultIsFoundForWhatItIs) {
  struct Case {
    const char* device;
    FaultKind kind;
    ErrorCode code;
  };
  const Case cases[] = {
      {"thermostat", FaultKind::kTimeout, ErrorCode::kTimeout},
      {"thermostat", FaultKind::kLateAnswer, ErrorCode::kTimeout},
      {"thermostat", FaultKind::kBadChecksum, ErrorCode::kProtocol},
      {"thermostat", FaultKind::kNan, ErrorCode::kProtocol},
      {"thermostat", FaultKind::kException, ErrorCode::kDevice},
      {"thermostat", FaultKind::kUnplug, ErrorCode::kUnplugged},
      {"coil_vertical", FaultKind::kTimeout, ErrorCode::kTimeout},
      {"coil_vertical", FaultKind::kLateAnswer, ErrorCode::kTimeout},
      {"coil_vertical", FaultKind::kNan, ErrorCode::kProtocol},
      {"coil_vertical", FaultKind::kGarbage, ErrorCode::kProtocol},
      {"coil_vertical", FaultKind::kUnplug, ErrorCode::kUnplugged},
      {"magnetometer", FaultKind::kTimeout, ErrorCode::kTimeout},
      {"magnetometer", FaultKind::kStuck, ErrorCode::kStale},
      {"magnetometer", FaultKind::kUnplug, ErrorCode::kUnplugged},
      {"turntable", FaultKind::kTimeout, ErrorCode::kTimeout},
      {"turntable", FaultKind::kNan, ErrorCode::kProtocol},
      {"gyro", FaultKind::kTimeout, ErrorCode::kTimeout},
      {"gyro", FaultKind::kBadChecksum, ErrorCode::kProtocol},
      {"gyro", FaultKind::kBadSequence, ErrorCode::kProtocol},
      {"gyro", FaultKind::kGarbage, ErrorCode::kProtocol},
      {"gyro", FaultKind::kNan, ErrorCode::kProtocol},
  };
  for (const auto& [device, kind, code] : cases) {
    scenario_.faults.clear();
    add_fault(device, kind, 60.0);
    const auto bench = open();
    ASSERT_TRUE(bench) << bench.error().message;
    GyroBlock block;
    clock_.sleep_for(40s);
    ASSERT_TRUE(bench->gyro->read(block));
    clock_.sleep_for(20s);
    (void)bench->gyro->read(block);
    block.clear();
    clock_.sleep_for(10s);
    const std::string role = device;
    Status status;
    const auto take = [&](const auto& result) {
      if (!result) status = result.error();
    };
    if (role == "thermostat") take(bench->thermostat->read());
    if (role == "coil_vertical") take(bench->coil_vertical->read());
    // That an axis stands still shows in a few readings only.
    for (int i = 0; i < 5 && status && role == "magnetometer"; ++i) {
      clock_.sleep_for(1s);
      take(bench->magnetometer->read());
    }
    if (role == "turntable") take(bench->turntable->azimuth());
    if (role == "gyro") take(bench->gyro->read(block));
    ASSERT_FALSE(status) << device << " fault " << static_cast<int>(kind);
    EXPECT_EQ(status.error().code, code) << status.error().message;
    EXPECT_TRUE(status.error().message.starts_with(role + ": ")) << status.error().message;
    EXPECT_TRUE(block.index.empty()) << status.error().message;
  }
}

}  // namespace
}  // namespace fogbench::drivers
