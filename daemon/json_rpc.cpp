#include "daemon/json_rpc.hpp"

#include <fmt/format.h>

#include "config/json_file.hpp"

namespace fogbench::daemon {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

template <class Json>
std::string dumped(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Within `message`, for a line that begins with the protocol's name.
std::string line_of(const std::string& members) {
  return R"({"jsonrpc":"2.0",)" + members + "}\n";
}

bool is_version_2(const json& message) {
  const auto version = message.find("jsonrpc");
  return version != message.end() && *version == "2.0";
}

/// Other numbers would come back as the nearest double: another id.
bool may_be_id(const json& id) {
  return id.is_string() || id.is_number_integer() || id.is_null();
}

}  // namespace

std::variant<RpcRequest, RpcRefusal> parse_request(std::string_view line) {
  auto parsed = config::parse_json(std::string(line), "request");
  if (!parsed) return RpcRefusal{"null", {RpcCode::kParse, parsed.error().message}};
  json& message = *parsed;
  if (!message.is_object()) {
    return RpcRefusal{"null", {RpcCode::kInvalidRequest, "request: found no object, expected one"}};
  }
  RpcRequest request;
  if (const auto id = message.find("id"); id != message.end()) {
    if (!may_be_id(*id)) {
      return RpcRefusal{"null",
                        {RpcCode::kInvalidRequest,
                         "request: /id: expected a string, or a whole number of 64 bits"}};
    }
    request.id = dumped(*id);
  }
  const auto refuse = [&](RpcCode code, const char* says) {
    return RpcRefusal{request.id.empty() ? "null" : request.id, {code, says}};
  };
  if (!is_version_2(message)) {
    return refuse(RpcCode::kInvalidRequest, "request: /jsonrpc: expected \"2.0\"");
  }
  const auto method = message.find("method");
  if (method == message.end() || !method->is_string()) {
    return refuse(RpcCode::kInvalidRequest, "request: /method: expected a method's name");
  }
  request.method = method->get<std::string>();
  if (const auto params = message.find("params"); params != message.end()) {
    if (!params->is_object()) {
      return refuse(RpcCode::kInvalidParams, "request: /params: expected an object");
    }
    request.params = std::move(*params);
  }
  return request;
}

std::string format_request(int id, const std::string& method, const ordered_json& params) {
  return line_of(fmt::format(R"("id":{},"method":{},"params":{})", id, dumped(ordered_json(method)),
                             dumped(params)));
}

std::string format_result(const std::string& id, const ordered_json& result) {
  return line_of(fmt::format(R"("id":{},"result":{})", id, dumped(result)));
}

std::string format_error(const std::string& id, const RpcError& error) {
  return line_of(fmt::format(R"("id":{},"error":{{"code":{},"message":{}}})", id,
                             static_cast<int>(error.code), dumped(ordered_json(error.message))));
}

std::string format_notification(const std::string& method, const ordered_json& params) {
  return line_of(
      fmt::format(R"("method":{},"params":{})", dumped(ordered_json(method)), dumped(params)));
}

Result<std::variant<RpcAnswer, RpcNotification>> parse_answer(std::string_view line) {
  const auto wrong = [&](const std::string& why) {
    return Error{ErrorCode::kProtocol, fmt::format("the daemon's answer makes no sense: {}: {}",
                                                   why, config::one_line(line))};
  };
  auto parsed = config::parse_json(std::string(line), "answer");
  if (!parsed) return wrong(parsed.error().message);
  json& message = *parsed;
  if (!message.is_object() || !is_version_2(message)) return wrong("no JSON-RPC 2.0");
  using Message = std::variant<RpcAnswer, RpcNotification>;
  if (const auto method = message.find("method"); method != message.end()) {
    const auto params = message.find("params");
    if (!method->is_string() || params == message.end()) return wrong("no notification");
    return Message{RpcNotification{method->get<std::string>(), std::move(*params)}};
  }
  const auto id = message.find("id");
  if (id == message.end() || !may_be_id(*id)) return wrong("no id");
  if (const auto result = message.find("result"); result != message.end()) {
    return Message{RpcAnswer{dumped(*id), std::move(*result)}};
  }
  const auto error = message.find("error");
  if (error == message.end() || !error->is_object()) return wrong("no result and no error");
  const auto code = error->find("code"), says = error->find("message");
  if (code == error->end() || !code->is_number_integer() || says == error->end() ||
      !says->is_string()) {
    return wrong("an error without code and message");
  }
  return Message{RpcAnswer{
      dumped(*id), RpcError{static_cast<RpcCode>(code->get<int>()), says->get<std::string>()}}};
}

}  // namespace fogbench::daemon
