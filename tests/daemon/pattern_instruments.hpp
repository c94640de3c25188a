#pragma once
// Instruments whose every number is another one, and none is 0: what is read wrongly shows.

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/transport.hpp"

namespace fogbench::daemon {

inline std::uint8_t pattern(std::size_t at) {
  return static_cast<std::uint8_t>(0xA1 + at * 7 % 0x1F);
}
class PatternRegisters final : public drivers::ModbusTransport {
 public:
  Status read_registers(std::uint16_t address, std::span<std::uint16_t> out) override {
    for (std::size_t i = 0; i < out.size(); ++i) {
      const std::size_t at = address + i;
      out[i] = static_cast<std::uint16_t>(pattern(2 * at) << 8 | pattern(2 * at + 1));
    }
    return {};
  }
  Status write_registers(std::uint16_t, std::span<const std::uint16_t>) override { return {}; }
};
class PatternReports final : public drivers::HidTransport {
 public:
  Result<std::size_t> read_report(std::span<std::uint8_t> out, drivers::Clock::Duration) override {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = pattern(i);
    return out.size();
  }
  Status write_report(std::span<const std::uint8_t>) override { return {}; }
};

}  // namespace fogbench::daemon
