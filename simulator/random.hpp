#pragma once
// Seeded randomness, repeatable bit for bit. Each noise source owns a generator whose seed is
// derived from the run's seed and the source's name, so that a new source or a fault never changes
// the numbers of another.

#include <bit>
#include <boost/random/normal_distribution.hpp>
#include <cstdint>
#include <limits>
#include <string_view>

namespace fogbench::simulator {

inline constexpr std::uint64_t kGoldenGamma = 0x9E3779B97F4A7C15U;

/// The output of SplitMix64 (Steele, Lea, Flood 2014) in state `x`; its next state is
/// x + kGoldenGamma.
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x += kGoldenGamma;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

constexpr std::uint64_t derive_seed(std::uint64_t seed, std::uint64_t index) {
  return mix_bits(mix_bits(seed) ^ index);
}

constexpr std::uint64_t derive_seed(std::uint64_t seed, std::string_view name) {
  std::uint64_t hash = seed;
  for (const char c : name) hash = derive_seed(hash, static_cast<unsigned char>(c));
  return hash;
}

/// xoshiro256++ (Blackman and Vigna 2019), state filled by SplitMix64 as its authors advise.
class RandomEngine {
 public:
  using result_type = std::uint64_t;
  explicit constexpr RandomEngine(std::uint64_t seed) {
    for (std::uint64_t& word : state_) {
      word = mix_bits(seed);
      seed += kGoldenGamma;
    }
  }
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }

  constexpr result_type operator()() {
    const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t shifted = state_[1] << 17U;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }

 private:
  std::uint64_t state_[4]{};
};

/// Standard normal deviates by Boost's ziggurat.
class NormalSource {
 public:
  explicit NormalSource(std::uint64_t seed) : engine_(seed) {}
  double operator()() { return normal_(engine_); }
  /// Uniform in (0, 1).
  double uniform() { return (static_cast<double>(engine_() >> 11U) + 0.5) * 0x1p-53; }

 private:
  RandomEngine engine_;
  boost::random::normal_distribution<double> normal_;
};

}  // namespace fogbench::simulator
