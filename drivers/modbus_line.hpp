#pragma once
// One open way to Modbus units, TCP or a serial line, by libmodbus: it connects and receives, and
// checks RTU's check value. Which answer belongs to which request is decided by modbus_messages.

#include <memory>

#include "config/connection.hpp"
#include "config/result.hpp"
#include "drivers/modbus_messages.hpp"

namespace fogbench::drivers {

class ModbusLine {
 public:
  virtual ~ModbusLine() = default;
  /// Sends a request and waits for its answer, which is one to it or an exception. A late one is
  /// never taken for the next. Errors: kTimeout, kProtocol, kUnplugged.
  virtual Result<modbus::Bytes> ask(const modbus::Bytes& request) = 0;
  /// False once nothing can come over it any more: it must be opened anew.
  virtual bool is_usable() const = 0;
};

/// Errors: kUnplugged.
Result<std::unique_ptr<ModbusLine>> connect_modbus(const config::TcpConnection& connection);
/// Errors: kUnplugged, kHeld.
Result<std::unique_ptr<ModbusLine>> connect_modbus(const config::RtuConnection& connection,
                                                   std::uint8_t unit);

}  // namespace fogbench::drivers
