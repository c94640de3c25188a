// The gyro at its bytes.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "drivers/crc.hpp"
#include "drivers/number_codec.hpp"
#include "tests/simulator/test_bench.hpp"

namespace fogbench::simulator {
namespace {

using config::FaultKind;
using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kFrame = 36;

/// Everything that has arrived, read in pieces of `piece` bytes.
Bytes read_all(TestFarEnds& bench, std::size_t piece = 4096) {
  Bytes all;
  Bytes buffer(piece);
  for (;;) {
    const auto count = bench.ends.gyro->read_some(std::as_writable_bytes(std::span(buffer)));
    if (!count || *count == 0) return all;
    all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*count));
  }
}

struct Frame {
  double rate_deg_per_h;
  int sequence;
  int temperature_c;
  bool crc_holds;
  int status;
};

std::vector<Frame> frames_of(const Bytes& bytes) {
  const config::FrameDevice device = test_gyro(100.0);
  const drivers::Crc crc(device.crc);
  std::vector<Frame> frames;
  for (std::size_t i = 0; i + kFrame <= bytes.size(); i += kFrame) {
    const std::uint8_t* frame = bytes.data() + i;
    const std::uint32_t bits = drivers::load_bytes(frame + 4, 4, config::ByteOrder::kBigEndian);
    frames.push_back({static_cast<double>(std::bit_cast<float>(bits)) * 3600.0, frame[29],
                      frame[30] << 8U | frame[31], crc.holds(frame), frame[28]});
  }
  return frames;
}

TEST(GyroFarEnd, SendsWholeFramesOfTheLayoutAtTheFrameRate) {
  TestFarEnds bench;
  EXPECT_TRUE(read_all(bench).empty());
  bench.run_for(0.0101);
  const Bytes first = read_all(bench);
  ASSERT_EQ(first.size(), kFrame);
  EXPECT_EQ(Bytes(first.begin(), first.begin() + 4), (Bytes{0xFE, 0x81, 0xFF, 0x55}));
  EXPECT_EQ(first[28], 0x01);
  EXPECT_EQ(Bytes(first.begin() + 16, first.begin() + 20), (Bytes{0x3F, 0x80, 0, 0}));  // 1 g
  bench.run_for(10.0);
  const std::vector<Frame> frames = frames_of(read_all(bench));
  ASSERT_EQ(frames.size(), 1000U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_TRUE(frames[i].crc_holds);
    ASSERT_EQ(frames[i].sequence, static_cast<int>((i + 1) % 128));
    ASSERT_EQ(frames[i].temperature_c, 21);
    ASSERT_NEAR(frames[i].rate_deg_per_h, 12.433, 1e-5);
  }
}

TEST(GyroFarEnd, RateIsEarthRatePlusEffectsPlusNoise) {
  config::ScenarioConfig scenario;
  scenario.noise.angle_random_walk_deg_per_sqrt_h = 0.001;
  scenario.terms = {{"bias", 0.5}, {"magnetic_linear_x", -0.2}};
  TestFarEnds bench(test_bench(), scenario);
  bench.run_for(100.0);
  const std::vector<Frame> frames = frames_of(read_all(bench));
  double sum = 0.0;
  double squares = 0.0;
  for (const Frame& frame : frames) sum += frame.rate_deg_per_h;
  const double mean = sum / 1e4;
  for (const Frame& frame : frames) squares += std::pow(frame.rate_deg_per_h - mean, 2);
  const double sigma = 0.001 * std::sqrt(3600.0 / 0.01);
  EXPECT_NEAR(mean, 12.433 + 0.5 - 0.2 * -0.5, 5.0 * sigma / 100.0);
  EXPECT_NEAR(std::sqrt(squares / 1e4) / sigma, 1.0, 5.0 / std::sqrt(2e4));
}

TEST(GyroFarEnd, EffectsFollowTheBenchWithinAStep) {
  config::ScenarioConfig scenario;
  scenario.terms = {{"magnetic_linear_y", 1.0}};
  TestFarEnds bench(test_bench(), scenario);
  ASSERT_TRUE(bench.ends.coil_vertical->write("OUTP ON;CURR 2"));
  bench.run_for(5.0);
  const std::vector<Frame> frames = frames_of(read_all(bench));
  const double field = 16.0 + 2.0 * 89.9 * std::cos(0.3 * M_PI / 180.0);
  EXPECT_NEAR(frames.back().rate_deg_per_h, 12.433 + field / 100.0, 1e-4);
  EXPECT_NEAR(frames.front().rate_deg_per_h, 12.433 + 0.16, 1e-4);
}

TEST(GyroFarEnd, BytesDependNeitherOnHowMuchNorOnWhenIsRead) {
  config::ScenarioConfig scenario;
  scenario.noise = {0.005, 0.02, 0.02, 1e-6};
  scenario.terms = {{"temperature_linear", 0.1}};
  // The second rate has no whole number of frames in a step of the plant, the third less than one.
  for (const double frame_rate_hz : {100.0, 128.7, 3.3}) {
    const config::BenchConfig config = test_bench(frame_rate_hz);
    TestFarEnds whole(config, scenario, 42);
    whole.run_for(120.0);
    const Bytes expected = read_all(whole, 1U << 20U);
    ASSERT_EQ(expected.size(),
              static_cast<std::size_t>(std::lround(120.0 * frame_rate_hz)) * kFrame);

    TestFarEnds pieces(config, scenario, 42);
    Bytes found;
    for (int i = 0; i < 1200; ++i) {
      pieces.run_for(0.1);
      const Bytes some = read_all(pieces, 1 + static_cast<std::size_t>(i) % 101);
      found.insert(found.end(), some.begin(), some.end());
    }
    EXPECT_TRUE(found == expected) << frame_rate_hz;

    TestFarEnds other(config, scenario, 43);
    other.run_for(120.0);
    EXPECT_FALSE(read_all(other) == expected) << frame_rate_hz;
  }
}

TEST(GyroFarEnd, AReaderThatWasAwayFindsTheLastTenMinutes) {
  TestFarEnds bench;
  bench.run_for(700.003);
  const std::vector<Frame> frames = frames_of(read_all(bench));
  EXPECT_NEAR(static_cast<double>(frames.size()), 60000.0, 20.0);
  const std::size_t lost = 70000 - frames.size();
  EXPECT_EQ(frames.front().sequence, static_cast<int>(lost % 128));
}

TEST(GyroFarEnd, TakesCommandsWithoutAnAnswer) {
  TestFarEnds bench;
  EXPECT_TRUE(bench.ends.gyro->write({}));
}

TEST(GyroFarEnd, AnswersARateBeyondItsFieldWithAnInvalidStatus) {
  config::BenchConfig config = test_bench();
  config.gyro.device.rate.type = config::NumberType::kInt16;
  config.gyro.device.rate.scale = 1e-4;
  TestFarEnds bench(config);
  bench.run_for(0.1);
  EXPECT_EQ(read_all(bench)[28], 0);
}

TEST(GyroFarEnd, FailsInTheWaysOfTheScenarioWithoutTouchingOtherFrames) {
  config::ScenarioConfig clean;
  clean.noise.angle_random_walk_deg_per_sqrt_h = 0.001;
  TestFarEnds undisturbed(test_bench(), clean);
  undisturbed.run_for(10.0);
  const std::vector<Frame> expected = frames_of(read_all(undisturbed));

  const auto with = [&](FaultKind kind) {
    config::ScenarioConfig scenario = clean;
    scenario.faults = {fault("gyro", kind, 5.0, 0.1)};
    TestFarEnds bench(test_bench(), scenario);
    bench.run_for(10.0);
    std::vector<Frame> frames = frames_of(read_all(bench));
    for (const std::size_t i : {std::size_t{0}, std::size_t{499}}) {
      EXPECT_EQ(frames[i].rate_deg_per_h, expected[i].rate_deg_per_h);
    }
    EXPECT_EQ(frames.back().rate_deg_per_h, expected.back().rate_deg_per_h);
    EXPECT_EQ(frames.back().sequence, expected.back().sequence);
    return frames;
  };
  for (const FaultKind silent : {FaultKind::kTimeout, FaultKind::kUnplug}) {
    const std::vector<Frame> frames = with(silent);
    ASSERT_EQ(frames.size(), 990U);
    EXPECT_EQ(frames[500].sequence, 510 % 128);
  }
  EXPECT_FALSE(with(FaultKind::kBadChecksum)[505].crc_holds);
  EXPECT_FALSE(with(FaultKind::kGarbage)[505].crc_holds);
  EXPECT_TRUE(std::isnan(with(FaultKind::kNan)[505].rate_deg_per_h));
  EXPECT_EQ(with(FaultKind::kBadSequence)[505].sequence, 499 % 128);
  const std::vector<Frame> stuck = with(FaultKind::kStuck);
  EXPECT_EQ(stuck[509].rate_deg_per_h, expected[499].rate_deg_per_h);
  EXPECT_EQ(stuck[509].sequence, 509 % 128);
  EXPECT_NE(stuck[510].rate_deg_per_h, expected[499].rate_deg_per_h);
  EXPECT_EQ(with(FaultKind::kException)[505].status, 0);
}

/// How many frames have come by each half second, from 5 s to 8 s.
std::vector<std::size_t> arrivals(const config::FaultSpec& spec) {
  config::ScenarioConfig scenario;
  scenario.faults = {spec};
  TestFarEnds bench(test_bench(), scenario);
  bench.run_for(5.0);
  std::size_t total = read_all(bench).size() / 36;
  std::vector<std::size_t> counts{total};
  for (int i = 0; i < 6; ++i) {
    bench.run_for(0.5);
    total += read_all(bench).size() / 36;
    counts.push_back(total);
  }
  return counts;
}

TEST(GyroFarEnd, ALineThatStallsBringsItsFramesTogetherAndLosesNone) {
  using Counts = std::vector<std::size_t>;
  EXPECT_EQ(arrivals(fault("gyro", FaultKind::kLateAnswer, 5.2, 2.0)),
            (Counts{500, 520, 520, 520, 520, 750, 800}));
  EXPECT_EQ(arrivals(fault("gyro", FaultKind::kSlowAnswer, 5.2, 2.0)),
            (Counts{500, 520, 520, 611, 611, 750, 800}));
}

TEST(GyroFarEnd, FaultsCanBeCountedInFrames) {
  config::FaultSpec late = fault("gyro", FaultKind::kLateAnswer, 0.0, 0.0);
  late.at_operation = 521;
  late.operations = 100;
  EXPECT_EQ(arrivals(late), (std::vector<std::size_t>{500, 520, 520, 650, 700, 750, 800}));
  config::FaultSpec unplugged = late;
  unplugged.kind = FaultKind::kTimeout;
  EXPECT_EQ(arrivals(unplugged).back(), 700U);
}

TEST(GyroFarEnd, SaysThatItIsUnpluggedWhileItIs) {
  config::ScenarioConfig scenario;
  scenario.faults = {fault("gyro", FaultKind::kUnplug, 5.0, 1.0)};
  TestFarEnds bench(test_bench(), scenario);
  bench.run_for(5.5);
  std::byte buffer[64];
  const auto read = bench.ends.gyro->read_some(buffer);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kUnplugged);
}

TEST(GyroFarEnd, AnotherGyroHasNoPast) {
  config::ScenarioConfig scenario;
  scenario.hidden = {{.effect = "drift_linear", .amplitude = 3600.0, .parameters = {}}};
  TestFarEnds bench(test_bench(), scenario);
  bench.run_for(100.005);
  const double drifted = frames_of(read_all(bench)).back().rate_deg_per_h;
  bench.ends.exchange_gyro();
  bench.run_for(0.2);
  const std::vector<Frame> fresh = frames_of(read_all(bench));
  ASSERT_FALSE(fresh.empty());
  EXPECT_EQ(fresh.front().sequence, 0);
  EXPECT_NEAR(drifted, 12.433 + 100.0, 1.0);
  EXPECT_NEAR(fresh.back().rate_deg_per_h, 12.433, 1.0);
}

}  // namespace
}  // namespace fogbench::simulator
