#pragma once

#include <cstdint>

namespace fogbench::simulator {

/// Why a Modbus request is refused (Modbus application protocol 1.1b3, section 7).
enum ModbusException : std::uint8_t {
  kIllegalFunction = 1,
  kIllegalAddress = 2,
  kIllegalValue = 3,
  kDeviceFailure = 4,
};

}  // namespace fogbench::simulator
