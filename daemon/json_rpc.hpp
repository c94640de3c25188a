#pragma once
// JSON-RPC 2.0 as protocol.md speaks it: one message a line. Text to message and back, nothing
// else: no socket, no clock, no state, so that a test can throw anything at it.

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <variant>

#include "config/result.hpp"

namespace fogbench::daemon {

inline constexpr int kProtocolVersion = 1;

/// The longest line that a client may send, its newline included.
inline constexpr std::size_t kLongestRequest = 16384;

/// What an error answer says besides its sentence; protocol.md explains each.
enum class RpcCode : int {
  kParse = -32700,
  kInvalidRequest = -32600,
  kMethodNotFound = -32601,
  kInvalidParams = -32602,
  kInternal = -32603,
  kPermission = -32001,
  kWrongState = -32002,
  kBadInput = -32003,
  kLimit = -32004,
  kNotFound = -32005,
  kQueueFull = -32006,
  kTooLong = -32007,
  kTooManyConnections = -32008,
  kStore = -32009,
};

struct RpcError {
  RpcCode code;
  std::string message;
};

struct RpcRequest {
  std::string id;  ///< its JSON text, to be sent back as it came; empty: wants no answer
  std::string method;
  nlohmann::json params = nlohmann::json::object();
};

/// Why a line is no request, and which answer it gets.
struct RpcRefusal {
  std::string id = "null";
  RpcError error;
};

/// Never throws, whatever the bytes.
std::variant<RpcRequest, RpcRefusal> parse_request(std::string_view line);

// Each is one line, ended. Bytes that are not UTF-8 become U+FFFD.
std::string format_request(int id, const std::string& method, const nlohmann::ordered_json& params);
std::string format_result(const std::string& id, const nlohmann::ordered_json& result);
std::string format_error(const std::string& id, const RpcError& error);
std::string format_notification(const std::string& method, const nlohmann::ordered_json& params);

/// What a client receives: the answer to one of its requests, or a notification.
struct RpcAnswer {
  std::string id;
  std::variant<nlohmann::json, RpcError> outcome;
};
struct RpcNotification {
  std::string method;
  nlohmann::json params;
};

/// kProtocol for anything else.
Result<std::variant<RpcAnswer, RpcNotification>> parse_answer(std::string_view line);

}  // namespace fogbench::daemon
