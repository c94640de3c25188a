#include "drivers/modbus_port.hpp"

#include <fmt/format.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <optional>

#include "drivers/deadline.hpp"
#include "drivers/reconnect.hpp"
#include "drivers/usb_adapter.hpp"

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;

/// What a controller may take to think; the time on the wire comes on top.
constexpr Clock::Duration kModbusTimeout = 500ms;
/// A frame on a serial line ends with a silence of 3.5 characters, 1.75 ms above 19200 baud
/// (Modbus over serial line V1.02, 2.5.1.1).
constexpr double kSilentCharacters = 3.5;
constexpr double kShortestSilence_s = 0.00175;
constexpr double kBitsPerCharacter = 11.0;
/// Unit, function, address, count, byte count and check value of request and answer together.
constexpr std::size_t kFrameBytes = 24;

struct ModbusCloser {
  void operator()(modbus_t* line) const {
    modbus_close(line);
    modbus_free(line);
  }
};

/// An open line. Closed by its destructor.
struct ModbusLine {
  std::unique_ptr<modbus_t, ModbusCloser> context;
};

Error last_error(const std::string& what) {
  return {ErrorCode::kUnplugged, fmt::format("{}: {}", what, modbus_strerror(errno))};
}

void set_timeout(modbus_t* context, Clock::Duration timeout) {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(timeout).count();
  modbus_set_response_timeout(context, static_cast<std::uint32_t>(us / 1'000'000),
                              static_cast<std::uint32_t>(us % 1'000'000));
}

Result<std::unique_ptr<ModbusLine>> connect(modbus_t* made, const std::string& where,
                                            std::uint8_t unit) {
  if (made == nullptr) return last_error(where);
  auto line = std::make_unique<ModbusLine>();
  line->context.reset(made);
  set_timeout(made, kModbusTimeout);
  // Without a limit between bytes, the limit of the answer holds for the whole of it.
  modbus_set_byte_timeout(made, 0, 0);
  modbus_set_error_recovery(made, MODBUS_ERROR_RECOVERY_NONE);
  if (modbus_set_slave(made, unit) != 0 || modbus_connect(made) != 0) {
    return last_error("cannot connect to " + where);
  }
  return line;
}

class ModbusPort final : public ModbusTransport {
 public:
  using Open = std::function<Result<std::unique_ptr<ModbusLine>>()>;

  /// `character` is the time of one on a serial line, zero on TCP.
  ModbusPort(std::string where, Clock::Duration character, Clock& clock, Open open)
      : where_(std::move(where)), character_(character), line_(clock, std::move(open)) {}

  Status read_registers(std::uint16_t address, std::span<std::uint16_t> out) override {
    const auto line = begin(out.size());
    if (!line) return line.error();
    const auto count = static_cast<int>(out.size());
    const int done = modbus_read_registers(*line, address, count, out.data());
    return done == count ? Status{} : failure(*line, errno);
  }

  Status write_registers(std::uint16_t address, std::span<const std::uint16_t> values) override {
    const auto line = begin(values.size());
    if (!line) return line.error();
    const auto count = static_cast<int>(values.size());
    const int done = modbus_write_registers(*line, address, count, values.data());
    return done == count ? Status{} : failure(*line, errno);
  }

 private:
  bool is_serial() const { return character_ > Clock::Duration::zero(); }

  /// The line, ready for a request about `words` registers.
  Result<modbus_t*> begin(std::size_t words) {
    const auto line = line_.get();
    if (!line) return line.error();
    modbus_t* context = (*line)->context.get();
    if (is_serial()) {
      set_timeout(context, kModbusTimeout + character_ * (kFrameBytes + 2 * words));
      SteadyClock().sleep_for(std::max(from_seconds(kShortestSilence_s),
                                       from_seconds(kSilentCharacters * to_seconds(character_))));
    }
    modbus_flush(context);
    return context;
  }

  Error failure(modbus_t* context, int error) {
    const std::string why = modbus_strerror(error);
    const int exception = error - MODBUS_ENOBASE;
    if (exception > 0 && exception < MODBUS_EXCEPTION_MAX) {
      return {ErrorCode::kDevice, fmt::format("Modbus exception {} ({})", exception, why)};
    }
    const bool late = error == ETIMEDOUT;
    const bool garbled = error >= EMBBADCRC && error <= EMBBADSLAVE;
    if (is_serial() && (late || garbled)) {
      drop_late_answer(modbus_get_socket(context));
    } else {
      line_.lost();
    }
    if (late) return {ErrorCode::kTimeout, "no answer from " + where_};
    if (garbled) return {ErrorCode::kProtocol, fmt::format("{} answers {}", where_, why)};
    return {ErrorCode::kUnplugged, fmt::format("{} is gone: {}", where_, why)};
  }

  static void drop_late_answer(int fd) {
    const Deadline deadline(kModbusTimeout);
    std::array<std::byte, 256> dropped;
    pollfd arrived{fd, POLLIN, 0};
    while (::poll(&arrived, 1, deadline.left_ms()) > 0) {
      if (::read(fd, dropped.data(), dropped.size()) <= 0) return;
    }
  }

  std::string where_;
  Clock::Duration character_;
  Reconnecting<ModbusLine> line_;
};

}  // namespace

Result<std::unique_ptr<ModbusTransport>> open_modbus(const config::TcpConnection& connection,
                                                     std::uint8_t unit, Clock& clock) {
  const std::string where = fmt::format("{}:{}", connection.host, connection.port);
  const auto open = [connection, where, unit] {
    return connect(
        modbus_new_tcp_pi(connection.host.c_str(), std::to_string(connection.port).c_str()), where,
        unit);
  };
  return Result<std::unique_ptr<ModbusTransport>>(
      std::make_unique<ModbusPort>(where, Clock::Duration::zero(), clock, open));
}

Result<std::unique_ptr<ModbusTransport>> open_modbus(const config::RtuConnection& connection,
                                                     std::uint8_t unit, Clock& clock) {
  // Which adapter it was when first opened: another one may get its name when it is pulled.
  std::optional<std::string> adapter;
  const auto open = [connection, unit, adapter]() mutable -> Result<std::unique_ptr<ModbusLine>> {
    const std::string now = usb_adapter_of(connection.tty);
    if (adapter && now != *adapter && !now.empty()) {
      return Error{ErrorCode::kUnplugged,
                   fmt::format("{} is another adapter now: found {}, expected {}", connection.tty,
                               now, *adapter)};
    }
    auto line = connect(modbus_new_rtu(connection.tty.c_str(), static_cast<int>(connection.baud),
                                       connection.parity, 8, connection.stop_bits),
                        connection.tty, unit);
    if (line && !adapter) adapter = now;
    return line;
  };
  return Result<std::unique_ptr<ModbusTransport>>(
      std::make_unique<ModbusPort>(fmt::format("unit {} on {}", unit, connection.tty),
                                   from_seconds(kBitsPerCharacter / connection.baud), clock, open));
}

}  // namespace fogbench::drivers
