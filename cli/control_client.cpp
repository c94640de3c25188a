#include "cli/control_client.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <system_error>
#include <variant>

#include "cli/shell_word.hpp"
#include "daemon/control_socket.hpp"
#include "daemon/json_rpc.hpp"

namespace fogbench::cli {
namespace {

using daemon::RpcAnswer;
using daemon::RpcCode;
using daemon::RpcError;
using daemon::RpcNotification;
using nlohmann::json;

Error to_error(const RpcError& refused) {
  switch (refused.code) {
    case RpcCode::kBadInput:
      return Error{ErrorCode::kBadInput, refused.message};
    case RpcCode::kLimit:
      return Error{ErrorCode::kLimit, refused.message};
    default:
      return Error{ErrorCode::kDevice, refused.message};
  }
}

}  // namespace

void add_socket_option(CLI::App& command, std::string& socket) {
  command.add_option("--socket", socket,
                     "The daemon's control socket (default: $FOGBENCH_SOCKET, else the user's own "
                     "daemon's, else the service's)");
}

std::string socket_argument(const std::string& socket) {
  return socket.empty() ? "" : " --socket " + shell_word(socket);
}

std::string served_store() {
  const auto client = ControlClient::connect({}, std::chrono::seconds{1});
  if (!client) return "";
  const auto hello = (*client)->call("hello");
  return hello && hello->is_object() ? hello->value("store", "") : "";
}

Result<std::unique_ptr<ControlClient>> ControlClient::connect(const std::string& socket,
                                                              std::chrono::milliseconds patience) {
  const std::string path = socket.empty() ? daemon::socket_to_ask().string() : socket;
  if (const Status ok = daemon::check_socket_path(path); !ok) return ok.error();
  std::unique_ptr<ControlClient> client(
      new ControlClient(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0), path, patience));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  const int connected =
      ::connect(client->socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
  if (connected == 0) return client;
  if (errno == ENOENT || errno == ECONNREFUSED) {
    return Error{
        ErrorCode::kDevice,
        fmt::format("no fogbenchd serves {}: start one, or name its socket with --socket", path)};
  }
  if (errno == EACCES) {
    return Error{ErrorCode::kDevice,
                 fmt::format("permission denied: this user may not connect to {}", path)};
  }
  return Error{ErrorCode::kDevice,
               fmt::format("{}: {}", path, std::generic_category().message(errno))};
}

Error ControlClient::gone() const {
  return Error{ErrorCode::kDevice, fmt::format("the fogbenchd that served {} is gone", path_)};
}

Result<std::string> ControlClient::next_line(int timeout_ms) {
  while (true) {
    if (const std::size_t end = in_.find('\n'); end != std::string::npos) {
      std::string line = in_.substr(0, end);
      in_.erase(0, end + 1);
      return line;
    }
    pollfd file{socket_.get(), POLLIN, 0};
    const int ready = poll(&file, 1, timeout_ms);
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) {
      return Error{ErrorCode::kTimeout, fmt::format("the fogbenchd that serves {} has not answered "
                                                    "within {} s",
                                                    path_, timeout_ms / 1000)};
    }
    char buffer[16384];
    const ssize_t count = recv(socket_.get(), buffer, sizeof buffer, 0);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return gone();
    in_.append(buffer, static_cast<std::size_t>(count));
  }
}

Result<json> ControlClient::call(const std::string& method) {
  return call(method, nlohmann::ordered_json::object());
}

Result<json> ControlClient::call(const std::string& method, const nlohmann::ordered_json& params) {
  const std::string request = daemon::format_request(++calls_, method, params);
  if (request.size() > daemon::kLongestRequest) {
    return config::bad_input(fmt::format("the request has {} bytes, the daemon takes {}",
                                         request.size(), daemon::kLongestRequest));
  }
  // A daemon that turns this client away has said why before it closed: that is read below.
  (void)send(socket_.get(), request.data(), request.size(), MSG_NOSIGNAL);
  while (true) {
    const auto line = next_line(static_cast<int>(patience_.count()));
    if (!line) return line.error();
    auto message = daemon::parse_answer(*line);
    if (!message) return message.error();
    auto* answer = std::get_if<RpcAnswer>(&*message);
    if (answer == nullptr) continue;  // news of a subscription
    if (const auto* refused = std::get_if<RpcError>(&answer->outcome)) return to_error(*refused);
    if (answer->id == std::to_string(calls_)) return std::get<json>(std::move(answer->outcome));
  }
}

Result<json> ControlClient::next_status() {
  while (true) {
    const auto line = next_line(-1);
    if (!line) return line.error();
    auto message = daemon::parse_answer(*line);
    if (!message) return message.error();
    if (auto* news = std::get_if<RpcNotification>(&*message)) return std::move(news->params);
    const auto& answer = std::get<RpcAnswer>(*message);
    if (const auto* refused = std::get_if<RpcError>(&answer.outcome)) return to_error(*refused);
  }
}

}  // namespace fogbench::cli
