#include "drivers/modbus_line.hpp"

#include <fmt/format.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "drivers/deadline.hpp"
#include "drivers/exclusive_tty.hpp"

namespace fogbench::drivers {
namespace {

using modbus::Bytes;
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
constexpr std::size_t kCheckBytes = 2;
/// Of an echo of function 3 that is taken for an answer the library reads unit, function, address
/// and half the count; "byte count" is then the address's high byte.
constexpr std::size_t kEchoBytes = 5;

struct ModbusCloser {
  void operator()(modbus_t* line) const {
    modbus_close(line);
    modbus_free(line);
  }
};
using Context = std::unique_ptr<modbus_t, ModbusCloser>;

using Received = std::array<std::uint8_t, MODBUS_MAX_ADU_LENGTH>;

void set_timeout(modbus_t* context, Clock::Duration timeout) {
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(timeout).count();
  modbus_set_response_timeout(context, static_cast<std::uint32_t>(us / 1'000'000),
                              static_cast<std::uint32_t>(us % 1'000'000));
}

Error not_connected(const std::string& where) {
  return {ErrorCode::kUnplugged,
          fmt::format("cannot connect to {}: {}", where, modbus_strerror(errno))};
}

/// `unit` 0: no unit's answer is looked for by the library.
Result<Context> connected(modbus_t* made, const std::string& where, std::uint8_t unit) {
  if (made == nullptr) return not_connected(where);
  Context context(made);
  set_timeout(made, kModbusTimeout);
  // Without a limit between bytes, the limit of the answer holds for the whole of it.
  modbus_set_byte_timeout(made, 0, 0);
  modbus_set_error_recovery(made, MODBUS_ERROR_RECOVERY_NONE);
  if (modbus_set_slave(made, unit) != 0 || modbus_connect(made) != 0) return not_connected(where);
  return context;
}

Error receive_error(int error) {
  const std::string why = modbus_strerror(error);
  if (error == ETIMEDOUT) return {ErrorCode::kTimeout, "no answer"};
  if (error > MODBUS_ENOBASE) return {ErrorCode::kProtocol, why};
  return {ErrorCode::kUnplugged, why};
}

/// Reconnects by itself where the other side closes between two requests. Some gateways do so after
/// every answer: such a one is not given the chance to do it while the next request is on its way.
class TcpLine final : public ModbusLine {
 public:
  TcpLine(Context context, std::string where)
      : context_(std::move(context)), where_(std::move(where)) {}

  Result<Bytes> ask(const Bytes& request) override {
    if (const Status ready = make_ready(); !ready) return ready.error();
    auto answer = exchange(request);
    if (answer) {
      ++answers_;
      return answer;
    }
    // It may still come, so not over a connection that is used again.
    if (answer.error().code == ErrorCode::kUnplugged) note_closed();
    is_spoilt_ = true;
    return answer;
  }

  bool is_usable() const override { return is_usable_; }

 private:
  Status make_ready() {
    if (is_closed()) {
      note_closed();
    } else if (!is_spoilt_ && !(one_answer_each_ && answers_ > 0)) {
      return {};
    }
    modbus_close(context_.get());
    answers_ = 0;
    is_spoilt_ = false;
    is_usable_ = modbus_connect(context_.get()) == 0;
    return is_usable_ ? Status{} : not_connected(where_);
  }

  Result<Bytes> exchange(const Bytes& request) {
    modbus_flush(context_.get());
    const Bytes sent = modbus::encode_tcp(++transaction_, request);
    if (::send(socket(), sent.data(), sent.size(), MSG_NOSIGNAL) !=
        static_cast<ssize_t>(sent.size())) {
      return receive_error(errno);
    }
    Received bytes;
    const int count = modbus_receive_confirmation(context_.get(), bytes.data());
    if (count < 0) return receive_error(errno);
    auto answer =
        modbus::decode_tcp(transaction_, std::span(bytes).first(static_cast<std::size_t>(count)));
    if (!answer) return answer;
    if (const Status ours = modbus::check_answer(request, *answer); !ours) return ours.error();
    return answer;
  }

  bool is_closed() const {
    char next = 0;
    const ssize_t count = ::recv(socket(), &next, 1, MSG_PEEK | MSG_DONTWAIT);
    return count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR);
  }
  void note_closed() {
    if (answers_ == 1) one_answer_each_ = true;
  }
  int socket() const { return modbus_get_socket(context_.get()); }

  Context context_;
  std::string where_;
  std::uint16_t transaction_ = 0;
  int answers_ = 0;  ///< over this connection
  bool one_answer_each_ = false;
  bool is_spoilt_ = false;  ///< a late answer could come over this connection
  bool is_usable_ = true;
};

class RtuLine final : public ModbusLine {
 public:
  RtuLine(Context context, std::unique_ptr<FileDescriptor> claim,
          const config::RtuConnection& connection)
      : context_(std::move(context)),
        claim_(std::move(claim)),
        echoes_(connection.echoes),
        character_(from_seconds(kBitsPerCharacter / connection.baud)) {}

  Result<Bytes> ask(const Bytes& request) override {
    modbus_t* const line = context_.get();
    const std::size_t most = kFrameBytes + 2 * modbus::register_count(request);
    set_timeout(line, kModbusTimeout + character_ * most);
    SteadyClock().sleep_for(std::max(from_seconds(kShortestSilence_s),
                                     from_seconds(kSilentCharacters * to_seconds(character_))));
    modbus_flush(line);
    auto answer = exchange(request);
    if (answer) return answer;
    is_usable_ = answer.error().code != ErrorCode::kUnplugged;
    if (is_usable_) drop_late_answer();
    return answer;
  }

  bool is_usable() const override { return is_usable_; }

 private:
  Result<Bytes> exchange(const Bytes& request) {
    const int size = static_cast<int>(request.size());
    if (modbus_send_raw_request(context_.get(), request.data(), size) < 0) {
      return receive_error(errno);
    }
    if (echoes_) {
      if (const Status echo = take_echo(request); !echo) return echo.error();
    }
    Received bytes{};
    const int count = modbus_receive_confirmation(context_.get(), bytes.data());
    const int error = errno;
    if (count > 0) {
      const Bytes answer(bytes.begin(), bytes.begin() + count - std::ptrdiff_t{kCheckBytes});
      if (const Status ours = modbus::check_answer(request, answer); !ours) return ours.error();
      return answer;
    }
    if (count == 0) {  // the library found another unit's number and looked no further
      return Error{ErrorCode::kProtocol, fmt::format("an answer of unit {} to a request to unit {}",
                                                     bytes[0], request[0])};
    }
    Error failure = receive_error(error);
    if (!echoes_ && std::equal(request.begin(), request.begin() + kEchoBytes, bytes.begin())) {
      failure.message += "; what was sent came back: is the adapter one that echoes (:echo)?";
    }
    return failure;
  }

  /// What the adapter hears itself send.
  Status take_echo(const Bytes& request) {
    Bytes echo(request.size() + kCheckBytes);
    const Deadline deadline(kModbusTimeout + character_ * echo.size());
    pollfd arrived{socket(), POLLIN, 0};
    for (std::size_t taken = 0; taken < echo.size();) {
      if (::poll(&arrived, 1, deadline.left_ms()) <= 0) {
        return Error{ErrorCode::kTimeout, "no echo of what was sent"};
      }
      const ssize_t count = ::read(socket(), echo.data() + taken, echo.size() - taken);
      if (count <= 0) return receive_error(count == 0 ? ECONNRESET : errno);
      taken += static_cast<std::size_t>(count);
    }
    if (std::equal(request.begin(), request.end(), echo.begin())) return {};
    return Error{ErrorCode::kProtocol, "the echo is not what was sent"};
  }

  void drop_late_answer() const {
    const Deadline deadline(kModbusTimeout);
    Received dropped;
    pollfd arrived{socket(), POLLIN, 0};
    while (::poll(&arrived, 1, deadline.left_ms()) > 0) {
      if (::read(socket(), dropped.data(), dropped.size()) <= 0) return;
    }
  }

  int socket() const { return modbus_get_socket(context_.get()); }

  Context context_;
  std::unique_ptr<FileDescriptor> claim_;  ///< the lock on the line
  bool echoes_;
  Clock::Duration character_;
  bool is_usable_ = true;
};

}  // namespace

Result<std::unique_ptr<ModbusLine>> connect_modbus(const config::TcpConnection& connection) {
  const std::string where = fmt::format("{}:{}", connection.host, connection.port);
  auto context =
      connected(modbus_new_tcp_pi(connection.host.c_str(), std::to_string(connection.port).c_str()),
                where, 0);
  if (!context) return context.error();
  return Result<std::unique_ptr<ModbusLine>>(std::make_unique<TcpLine>(std::move(*context), where));
}

Result<std::unique_ptr<ModbusLine>> connect_modbus(const config::RtuConnection& connection,
                                                   std::uint8_t unit) {
  // libmodbus changes the line's settings when it opens it, so the line must be ours before.
  auto claim = open_exclusively(connection.tty);
  if (!claim) return claim.error();
  auto context = connected(modbus_new_rtu(connection.tty.c_str(), static_cast<int>(connection.baud),
                                          connection.parity, 8, connection.stop_bits),
                           connection.tty, unit);
  if (!context) return context.error();
  shut_others_out(modbus_get_socket(context->get()));
  return Result<std::unique_ptr<ModbusLine>>(
      std::make_unique<RtuLine>(std::move(*context), std::move(*claim), connection));
}

}  // namespace fogbench::drivers
