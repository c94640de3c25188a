#pragma once
// The fuzzer's bytes taken as a script: choices, numbers, and what goes over the wire.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace fogbench::fuzz {

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  bool empty() const { return rest_.empty(); }
  /// 0 at the end.
  std::uint8_t byte() {
    const auto taken = bytes(1);
    return taken.empty() ? std::uint8_t{0} : taken[0];
  }
  /// At most `count`.
  std::span<const std::uint8_t> bytes(std::size_t count) {
    const auto taken = rest_.first(std::min(count, rest_.size()));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }
  /// A number made of the next bytes, 0 where there are none.
  template <class T>
  T number() {
    T value{};
    const auto taken = bytes(sizeof value);
    if (!taken.empty()) std::memcpy(&value, taken.data(), taken.size());
    return value;
  }
  /// Up to the next line feed, which is taken too.
  std::string line() {
    const auto end = std::find(rest_.begin(), rest_.end(), std::uint8_t{'\n'});
    std::string text(rest_.begin(), end);
    rest_ = rest_.subspan(std::min(text.size() + 1, rest_.size()));
    return text;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// What must hold whatever comes; the fuzzer keeps the input that breaks it.
inline void require(bool holds) {
  if (!holds) __builtin_trap();
}

}  // namespace fogbench::fuzz
