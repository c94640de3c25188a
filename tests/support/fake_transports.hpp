#pragma once
// Transports whose far end is a script, for the drivers' tests. Each is shared with its test by
// reference: the test keeps the state, the driver owns a thin handle to it.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/transport.hpp"

namespace fogbench::support {

/// A serial line: bytes that the test puts in come out, at most `chunk` at a time.
struct FakeLine {
  std::deque<std::byte> bytes;
  std::size_t chunk = SIZE_MAX;
  std::optional<Error> failure;
  /// Called before every read: puts in what would have arrived by now.
  std::function<void()> before_read;

  void put(std::span<const std::uint8_t> more) {
    for (const std::uint8_t byte : more) bytes.push_back(std::byte{byte});
  }
};

class FakeSerial final : public drivers::SerialTransport {
 public:
  explicit FakeSerial(FakeLine& line) : line_(line) {}
  Result<std::size_t> read_some(std::span<std::byte> out) override {
    if (line_.before_read) line_.before_read();
    if (line_.failure) return *line_.failure;
    const std::size_t count = std::min({out.size(), line_.chunk, line_.bytes.size()});
    const auto end = line_.bytes.begin() + static_cast<std::ptrdiff_t>(count);
    std::copy(line_.bytes.begin(), end, out.begin());
    line_.bytes.erase(line_.bytes.begin(), end);
    return count;
  }
  Status write(std::span<const std::byte>) override { return {}; }

 private:
  FakeLine& line_;
};

}  // namespace fogbench::support
