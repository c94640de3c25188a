// How many gyro frames a second the receiving end can take: its CRC alone, and from bytes to
// GyroBlock with everything checked.

#include "drivers/frame_parser.hpp"

#include <benchmark/benchmark.h>

#include "tests/support/kvh_frame.hpp"

namespace fogbench::drivers {
namespace {

std::vector<std::uint8_t> stream_of(std::int64_t frames) {
  std::vector<std::uint8_t> bytes;
  for (std::int64_t i = 0; i < frames; ++i) {
    const auto frame = support::kvh_frame(i, 1e-3 * static_cast<double>(i));
    bytes.insert(bytes.end(), frame.begin(), frame.end());
  }
  return bytes;
}

void crc_of_a_frame(benchmark::State& state) {
  const Crc crc(support::kvh_device().crc);
  const auto bytes = stream_of(1024);
  for (auto _ : state) {
    for (std::size_t at = 0; at < bytes.size(); at += 36) {
      benchmark::DoNotOptimize(crc.holds(bytes.data() + at));
    }
  }
  state.SetItemsProcessed(state.iterations() * 1024);
}
BENCHMARK(crc_of_a_frame);

void parse_frames(benchmark::State& state) {
  const auto bytes = stream_of(1024);  // a whole number of turns: the sequence goes on
  FrameParser parser(support::kvh_device());
  GyroBlock block;
  for (auto _ : state) {
    block.clear();
    std::memcpy(parser.space().data(), bytes.data(), bytes.size());
    parser.parse(bytes.size(), block);
    parser.settle(std::nullopt, block);
    benchmark::DoNotOptimize(block.rate_deg_per_h.data());
  }
  state.SetItemsProcessed(state.iterations() * 1024);
  if (parser.statistics().frames_missing != 0) state.SkipWithError("frames were lost");
}
BENCHMARK(parse_frames);

}  // namespace
}  // namespace fogbench::drivers
