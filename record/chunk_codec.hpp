#pragma once
// One chunk of the raw gyro stream as it lies in the run log: three columns, each compressed by
// zstd, and a SHA-256 of what they hold. The format is documented in run-log.md.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "drivers/instruments.hpp"

struct ZSTD_CCtx_s;

namespace fogbench::record {

/// A chunk that claims more frames is damaged.
inline constexpr std::size_t kMaximumChunkFrames = std::size_t{1} << 20;

using Sha256 = std::array<std::byte, 32>;

struct Chunk {
  std::int64_t first_index = 0;
  std::int64_t frames = 0;
  std::vector<std::byte> index_runs;  ///< empty when every index follows the one before
  std::vector<std::byte> rate;
  std::vector<std::byte> temperature;  ///< empty when the frames carry none
  Sha256 sha256{};
};

/// Keeps its compressor and buffers from chunk to chunk.
class ChunkEncoder {
 public:
  ChunkEncoder();
  ~ChunkEncoder();

  /// All columns as long as `index`, which rises; `temperature_c` may be empty instead.
  /// Precondition: 0 < index.size() <= kMaximumChunkFrames.
  /// The chunk is valid until the next call. Errors: kStore, out of memory.
  Result<const Chunk*> encode(std::span<const std::int64_t> index,
                              std::span<const float> rate_deg_per_h,
                              std::span<const float> temperature_c);

 private:
  Status compress(std::span<const std::byte> plain, std::vector<std::byte>& out);
  Status compress_floats(std::span<const float> values, std::vector<std::byte>& out);

  struct FreeContext {
    void operator()(ZSTD_CCtx_s* context) const;
  };
  std::unique_ptr<ZSTD_CCtx_s, FreeContext> context_;
  std::vector<std::byte> shuffled_;
  Chunk chunk_;
};

/// Appends the chunk's frames to `out`. Errors: kStore, saying what is wrong with it.
Status decode_chunk(const Chunk& chunk, drivers::GyroBlock& out);

/// SHA-256 of bytes, for the run's hash over its chunks' hashes.
Sha256 sha256_of(std::span<const std::byte> bytes);
std::string hexadecimal(std::span<const std::byte> bytes);

}  // namespace fogbench::record
