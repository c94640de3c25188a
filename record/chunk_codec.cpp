#include "record/chunk_codec.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <zstd.h>

#include <bit>
#include <cassert>
#include <cstring>
#include <initializer_list>

namespace fogbench::record {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the columns are little-endian; a big-endian machine would have to swap them");

// Level 1: the mantissas of a noisy rate do not compress at any level, and the rest does at this.
constexpr int kLevel = 1;

/// Consecutive frames: `count` of them from `first_index + offset` on.
struct IndexRun {
  std::int64_t offset = 0;
  std::int64_t count = 0;
};

template <class T>
std::span<const std::byte> bytes_of(const T& values) {
  return std::as_bytes(std::span(values));
}

Sha256 hash(std::initializer_list<std::span<const std::byte>> parts) {
  Sha256 digest{};
  EVP_MD_CTX* context = EVP_MD_CTX_new();
  unsigned int length = 0;
  EVP_DigestInit_ex(context, EVP_sha256(), nullptr);
  for (const auto& part : parts) EVP_DigestUpdate(context, part.data(), part.size());
  EVP_DigestFinal_ex(context, reinterpret_cast<unsigned char*>(digest.data()), &length);
  EVP_MD_CTX_free(context);
  return digest;
}

Sha256 hash_chunk(std::int64_t first_index, std::int64_t frames, std::span<const IndexRun> runs,
                  std::span<const float> rate, std::span<const float> temperature) {
  const std::array<std::int64_t, 2> head{first_index, frames};
  return hash(
      {bytes_of(head), std::as_bytes(runs), std::as_bytes(rate), std::as_bytes(temperature)});
}

/// Empty when the index has no jump.
std::vector<IndexRun> runs_of(std::span<const std::int64_t> index) {
  std::vector<IndexRun> runs;
  const auto frames = static_cast<std::int64_t>(index.size());
  if (index.back() - index.front() == frames - 1) return runs;  // rising, so without a jump
  runs.push_back({0, 1});
  for (std::size_t i = 1; i < index.size(); ++i) {
    if (index[i] == index[i - 1] + 1) {
      ++runs.back().count;
    } else {
      runs.push_back({index[i] - index.front(), 1});
    }
  }
  return runs;
}

Error damaged_chunk(const std::string& what) {
  return Error{ErrorCode::kStore, "damaged chunk: " + what};
}

/// `out` is as long as the content must be.
Status decompress(std::span<const std::byte> blob, std::span<std::byte> out, const char* column) {
  const unsigned long long size = ZSTD_getFrameContentSize(blob.data(), blob.size());
  if (size != out.size()) {
    return damaged_chunk(fmt::format("column {} does not hold {} bytes", column, out.size()));
  }
  const std::size_t got = ZSTD_decompress(out.data(), out.size(), blob.data(), blob.size());
  if (ZSTD_isError(got) != 0 || got != out.size()) {
    return damaged_chunk(fmt::format("column {} cannot be decompressed", column));
  }
  return {};
}

Status decompress_floats(std::span<const std::byte> blob, std::span<float> out,
                         const char* column) {
  std::vector<std::byte> shuffled(out.size_bytes());
  if (const Status ok = decompress(blob, shuffled, column); !ok) return ok;
  const std::size_t n = out.size();
  for (std::size_t i = 0; i < n; ++i) {
    std::uint32_t word = 0;
    for (std::size_t plane = 4; plane-- > 0;) {
      word = word << 8 | std::to_integer<std::uint32_t>(shuffled[plane * n + i]);
    }
    out[i] = std::bit_cast<float>(word);
  }
  return {};
}

Result<std::vector<IndexRun>> decode_runs(const Chunk& chunk) {
  std::vector<IndexRun> runs;
  if (chunk.index_runs.empty()) return runs;
  const unsigned long long size =
      ZSTD_getFrameContentSize(chunk.index_runs.data(), chunk.index_runs.size());
  if (size % sizeof(IndexRun) != 0 || size > kMaximumChunkFrames * sizeof(IndexRun)) {
    return damaged_chunk("column index_runs has no valid length");
  }
  runs.resize(size / sizeof(IndexRun));
  if (const Status ok =
          decompress(chunk.index_runs, std::as_writable_bytes(std::span(runs)), "index_runs");
      !ok) {
    return ok.error();
  }
  std::int64_t total = 0, next = 0;
  for (const IndexRun& run : runs) {
    if (run.offset < next || run.count <= 0 || run.count > chunk.frames - total ||
        run.offset > (std::int64_t{1} << 60)) {
      return damaged_chunk("column index_runs makes no sense");
    }
    next = run.offset + run.count;
    total += run.count;
  }
  if (total != chunk.frames) return damaged_chunk("column index_runs does not count all frames");
  return runs;
}

}  // namespace

void ChunkEncoder::FreeContext::operator()(ZSTD_CCtx_s* context) const {
  ZSTD_freeCCtx(context);
}

ChunkEncoder::ChunkEncoder() : context_(ZSTD_createCCtx()) {}
ChunkEncoder::~ChunkEncoder() = default;

Status ChunkEncoder::compress(std::span<const std::byte> plain, std::vector<std::byte>& out) {
  out.resize(ZSTD_compressBound(plain.size()));
  const std::size_t size =
      ZSTD_compressCCtx(context_.get(), out.data(), out.size(), plain.data(), plain.size(), kLevel);
  if (ZSTD_isError(size) != 0) {
    return Error{ErrorCode::kStore,
                 fmt::format("compressing a chunk: {}", ZSTD_getErrorName(size))};
  }
  out.resize(size);
  return {};
}

Status ChunkEncoder::compress_floats(std::span<const float> values, std::vector<std::byte>& out) {
  // All first bytes, then all second bytes...: sign and exponent hardly change and compress away.
  const std::size_t n = values.size();
  shuffled_.resize(4 * n);
  for (unsigned plane = 0; plane < 4; ++plane) {
    std::byte* to = shuffled_.data() + plane * n;
    for (std::size_t i = 0; i < n; ++i) {
      to[i] = static_cast<std::byte>(std::bit_cast<std::uint32_t>(values[i]) >> (8 * plane));
    }
  }
  return compress(shuffled_, out);
}

Result<const Chunk*> ChunkEncoder::encode(std::span<const std::int64_t> index,
                                          std::span<const float> rate_deg_per_h,
                                          std::span<const float> temperature_c) {
  assert(!index.empty() && index.size() <= kMaximumChunkFrames);
  assert(rate_deg_per_h.size() == index.size());
  assert(temperature_c.empty() || temperature_c.size() == index.size());
  chunk_.first_index = index.front();
  chunk_.frames = static_cast<std::int64_t>(index.size());
  const std::vector<IndexRun> runs = runs_of(index);
  chunk_.index_runs.clear();
  if (!runs.empty()) {
    if (const Status ok = compress(bytes_of(runs), chunk_.index_runs); !ok) return ok.error();
  }
  if (const Status ok = compress_floats(rate_deg_per_h, chunk_.rate); !ok) return ok.error();
  chunk_.temperature.clear();
  if (!temperature_c.empty()) {
    if (const Status ok = compress_floats(temperature_c, chunk_.temperature); !ok) {
      return ok.error();
    }
  }
  chunk_.sha256 =
      hash_chunk(chunk_.first_index, chunk_.frames, runs, rate_deg_per_h, temperature_c);
  return &chunk_;
}

Status decode_chunk(const Chunk& chunk, drivers::GyroBlock& out) {
  if (chunk.frames <= 0 || chunk.frames > static_cast<std::int64_t>(kMaximumChunkFrames)) {
    return damaged_chunk(fmt::format("it claims {} frames", chunk.frames));
  }
  const auto frames = static_cast<std::size_t>(chunk.frames);
  const auto runs = decode_runs(chunk);
  if (!runs) return runs.error();
  std::vector<float> rate(frames);
  if (const Status ok = decompress_floats(chunk.rate, rate, "rate"); !ok) return ok;
  std::vector<float> temperature(chunk.temperature.empty() ? 0 : frames);
  if (!temperature.empty()) {
    const Status ok = decompress_floats(chunk.temperature, temperature, "temperature");
    if (!ok) return ok;
  }
  if (hash_chunk(chunk.first_index, chunk.frames, *runs, rate, temperature) != chunk.sha256) {
    return damaged_chunk("its content does not have the recorded SHA-256");
  }

  const IndexRun whole[] = {{0, chunk.frames}};
  for (const IndexRun& run : runs->empty() ? std::span<const IndexRun>(whole) : *runs) {
    for (std::int64_t i = 0; i < run.count; ++i) {
      out.index.push_back(chunk.first_index + run.offset + i);
    }
  }
  out.rate_deg_per_h.insert(out.rate_deg_per_h.end(), rate.begin(), rate.end());
  out.temperature_c.insert(out.temperature_c.end(), temperature.begin(), temperature.end());
  return {};
}

Sha256 sha256_of(std::span<const std::byte> bytes) {
  return hash({bytes});
}

std::string hexadecimal(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) text += fmt::format("{:02x}", std::to_integer<int>(byte));
  return text;
}

}  // namespace fogbench::record
