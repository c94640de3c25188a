#pragma once
// What lies between a driver and its instrument. A physical transport (libmodbus, hidapi, libusb,
// tty) or the simulated bench's far end implements these; the driver cannot tell which.
//
// Every call has a deadline of its own: it returns kTimeout rather than wait past it. After a
// time-out the transport has drained whatever was late, so that an old answer is never taken for
// the next one. None of these classes may be used from two threads at once.
//
// A transport whose instrument is gone returns kUnplugged, at least once for each time that it
// went: so a driver knows that the instrument may have lost what it was told. Until it is back
// every call fails so at once; a call after that reaches it again. One that nobody has reached yet
// is no different from one that is gone.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "config/result.hpp"
#include "drivers/clock.hpp"

namespace fogbench::drivers {

/// Modbus holding registers of one unit.
/// Errors: kTimeout, kDevice and kBusy (exception answer), kUnplugged, kProtocol.
class ModbusTransport {
 public:
  virtual ~ModbusTransport() = default;
  /// Reads out.size() registers from `address` on (function 3).
  virtual Status read_registers(std::uint16_t address, std::span<std::uint16_t> out) = 0;
  /// Writes (function 16). On a time-out the write may have been executed: read back.
  virtual Status write_registers(std::uint16_t address, std::span<const std::uint16_t> values) = 0;
};

/// HID input and output reports of one device.
class HidTransport {
 public:
  virtual ~HidTransport() = default;
  /// The newest whole input report, report id first; waits for one at most `timeout`.
  /// Returns its length.
  virtual Result<std::size_t> read_report(std::span<std::uint8_t> out, Clock::Duration timeout) = 0;
  virtual Status write_report(std::span<const std::uint8_t> report) = 0;
};

/// A message-based instrument (USBTMC, or lines over serial): one message out, one answer back.
class MessageTransport {
 public:
  virtual ~MessageTransport() = default;
  virtual Status write(std::string_view message) = 0;
  /// One whole answer without its terminator. On kTimeout the transport has aborted and drained.
  virtual Result<std::string> read(Clock::Duration timeout) = 0;
  /// USB488 clear: forgets whatever is under way on both sides.
  virtual Status clear() = 0;
  /// A message as the last thing that this process says, past whatever is under way: from any
  /// thread, once, without waiting for room or an answer. A way that is not open stays so.
  virtual void write_last(std::string_view /*message*/) noexcept {}
};

/// A stream of bytes.
class SerialTransport {
 public:
  virtual ~SerialTransport() = default;
  /// What has arrived by now, at most out.size() bytes; 0 when nothing has. Never waits.
  virtual Result<std::size_t> read_some(std::span<std::byte> out) = 0;
  virtual Status write(std::span<const std::byte> bytes) = 0;
  /// As MessageTransport::write_last().
  virtual void write_last(std::span<const std::byte> /*bytes*/) noexcept {}
};

/// The way to a sensor, whichever kind it is of.
using SensorTransport =
    std::variant<std::unique_ptr<ModbusTransport>, std::unique_ptr<MessageTransport>,
                 std::unique_ptr<HidTransport>, std::unique_ptr<SerialTransport>>;

/// Everything that a bench is reached through. The turntable's is null when it is the operator's
/// hand, the magnetometer's when there is none.
struct Transports {
  std::unique_ptr<ModbusTransport> thermostat;
  std::unique_ptr<MessageTransport> coil_horizontal;
  std::unique_ptr<MessageTransport> coil_vertical;
  std::unique_ptr<HidTransport> magnetometer;
  std::unique_ptr<MessageTransport> turntable;
  std::unique_ptr<SerialTransport> gyro;
  std::vector<SensorTransport> auxiliary;  ///< in the order of the bench file
  /// Of a simulated bench: the gyro turns to that azimuth, deg, when the operator says that it has
  /// been turned. Empty where he really turns it.
  std::function<void(double)> turned_by_hand;
  /// Of a simulated bench: another gyro of the same kind is put on, and switched on now.
  std::function<void()> exchange_gyro;
};

}  // namespace fogbench::drivers
