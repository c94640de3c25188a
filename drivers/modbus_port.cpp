#include "drivers/modbus_port.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "drivers/exclusive_tty.hpp"
#include "drivers/modbus_line.hpp"
#include "drivers/reconnect.hpp"
#include "drivers/usb_adapter.hpp"

namespace fogbench::drivers {
namespace {

using modbus::Bytes;

class ModbusPort final : public ModbusTransport {
 public:
  using Open = std::function<Result<std::unique_ptr<ModbusLine>>()>;

  ModbusPort(std::string where, std::uint8_t unit, InstrumentLock lock, Clock& clock, Open open)
      : where_(std::move(where)),
        unit_(unit),
        lock_(std::move(lock)),
        line_(clock, std::move(open)) {}

  Status read_registers(std::uint16_t address, std::span<std::uint16_t> out) override {
    const auto answer = ask(modbus::encode_read(unit_, address, out.size()));
    if (!answer) return answer.error();
    modbus::take_registers(*answer, out);
    return {};
  }

  Status write_registers(std::uint16_t address, std::span<const std::uint16_t> values) override {
    const auto answer = ask(modbus::encode_write(unit_, address, values));
    return answer ? Status{} : answer.error();
  }

 private:
  Result<Bytes> ask(const Bytes& request) {
    const auto line = line_.get();
    if (!line) return line.error();
    auto answer = (*line)->ask(request);
    if (!answer) {
      const Error failure = said(answer.error());
      if (!(*line)->is_usable()) line_.lost();
      return failure;
    }
    if (const Status refused = modbus::exception_in(*answer); !refused) return refused.error();
    return answer;
  }

  Error said(const Error& error) const {
    switch (error.code) {
      case ErrorCode::kTimeout:
        return {error.code, fmt::format("{} from {}", error.message, where_)};
      case ErrorCode::kUnplugged:
        return {error.code, fmt::format("{} is gone: {}", where_, error.message)};
      case ErrorCode::kProtocol:
        return {error.code, fmt::format("{}: {}", where_, error.message)};
      default:
        return error;
    }
  }
  std::string where_;
  std::uint8_t unit_;
  InstrumentLock lock_;
  Reconnecting<ModbusLine> line_;
};

}  // namespace

Result<std::unique_ptr<ModbusTransport>> open_modbus(const config::TcpConnection& connection,
                                                     std::uint8_t unit, Clock& clock) {
  const std::string where = fmt::format("{}:{}", connection.host, connection.port);
  // Several instruments may stand behind one gateway.
  auto lock = lock_instrument({fmt::format("unit {} at {}", unit, where)});
  if (!lock) return lock.error();
  return Result<std::unique_ptr<ModbusTransport>>(std::make_unique<ModbusPort>(
      where, unit, std::move(*lock), clock, [connection] { return connect_modbus(connection); }));
}

Result<std::unique_ptr<ModbusTransport>> open_modbus(const config::RtuConnection& connection,
                                                     std::uint8_t unit, Clock& clock) {
  if (!config::is_unit_of_serial_line(unit)) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("unit_id is {}; expected 1 to 247 on a serial line", unit)};
  }
  auto lock = lock_serial_line(connection.tty);
  if (!lock) return lock.error();
  // Which adapter it was when first opened: another one may get its name when it is pulled.
  std::optional<std::string> adapter;
  const auto open = [connection, unit, adapter]() mutable -> Result<std::unique_ptr<ModbusLine>> {
    const std::string now = usb_adapter_of(connection.tty);
    if (adapter && now != *adapter && !now.empty()) {
      return Error{ErrorCode::kUnplugged,
                   fmt::format("{} is another adapter now: found {}, expected {}", connection.tty,
                               now, *adapter)};
    }
    auto line = connect_modbus(connection, unit);
    if (line && !adapter) adapter = now;
    return line;
  };
  return Result<std::unique_ptr<ModbusTransport>>(std::make_unique<ModbusPort>(
      fmt::format("unit {} on {}", unit, connection.tty), unit, std::move(*lock), clock, open));
}

}  // namespace fogbench::drivers
