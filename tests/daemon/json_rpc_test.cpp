#include "daemon/json_rpc.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

namespace fogbench::daemon {
namespace {

RpcRequest request(std::string_view line) {
  auto parsed = parse_request(line);
  if (const auto* refused = std::get_if<RpcRefusal>(&parsed)) {
    ADD_FAILURE() << line << ": " << refused->error.message;
    return {};
  }
  return std::get<RpcRequest>(std::move(parsed));
}

RpcRefusal refusal(std::string_view line) {
  auto parsed = parse_request(line);
  if (std::holds_alternative<RpcRequest>(parsed)) {
    ADD_FAILURE() << "taken for a request: " << line;
    return {};
  }
  return std::get<RpcRefusal>(std::move(parsed));
}

TEST(JsonRpc, ReadsARequestWithItsIdAsItCame) {
  const RpcRequest one = request(R"({"jsonrpc":"2.0","id":7,"method":"status"})");
  EXPECT_EQ(one.id, "7");
  EXPECT_EQ(one.method, "status");
  EXPECT_TRUE(one.params.empty());
  EXPECT_EQ(request(R"({"jsonrpc":"2.0","id":"a\"b","method":"m"})").id, R"("a\"b")");
  EXPECT_EQ(request(R"({"jsonrpc":"2.0","id":null,"method":"m"})").id, "null");
  EXPECT_EQ(request(R"({"jsonrpc":"2.0","method":"m"})").id, "") << "a notification";
  for (const char* id : {"0", "-5", "9223372036854775808", "18446744073709551615"}) {
    EXPECT_EQ(request(fmt::format(R"({{"jsonrpc":"2.0","id":{},"method":"m"}})", id)).id, id);
  }
  const RpcRequest with =
      request(R"( {"method":"run","params":{"procedure":"x"},"jsonrpc":"2.0"} )");
  EXPECT_EQ(with.params.at("procedure"), "x");
}

TEST(JsonRpc, RefusesWhatIsNoRequestAndKeepsTheIdWhenThereIsOne) {
  EXPECT_EQ(refusal("").error.code, RpcCode::kParse);
  EXPECT_EQ(refusal(R"({"jsonrpc":"2.0","id":1,"method")").error.code, RpcCode::kParse);
  EXPECT_EQ(refusal("{\"id\":\"\xff\"}").error.code, RpcCode::kParse);
  EXPECT_EQ(refusal(std::string(10000, '[')).error.code, RpcCode::kParse);
  EXPECT_EQ(refusal(R"({"id":1,"id":2})").error.code, RpcCode::kParse);
  for (const char* line :
       {"[]", "7", R"([{"jsonrpc":"2.0","id":1,"method":"status"}])",
        R"({"jsonrpc":"2.0","id":[1],"method":"m"})", R"({"jsonrpc":"2.0","id":true,"method":"m"})",
        R"({"jsonrpc":"2.0","id":12345678901234567890123,"method":"m"})",
        R"({"jsonrpc":"2.0","id":1.5,"method":"m"})"}) {
    EXPECT_EQ(refusal(line).error.code, RpcCode::kInvalidRequest) << line;
    EXPECT_EQ(refusal(line).id, "null") << line;
  }
  for (const char* line :
       {R"({"id":3,"method":"m"})", R"({"jsonrpc":"1.0","id":3,"method":"m"})",
        R"({"jsonrpc":"2.0","id":3})", R"({"jsonrpc":"2.0","id":3,"method":["m"]})"}) {
    EXPECT_EQ(refusal(line).error.code, RpcCode::kInvalidRequest) << line;
    EXPECT_EQ(refusal(line).id, "3") << line;
  }
  EXPECT_EQ(refusal(R"({"jsonrpc":"2.0","id":3,"method":"m","params":[1]})").error.code,
            RpcCode::kInvalidParams);
}

TEST(JsonRpc, WhatIsFormattedIsOneLineThatReadsBack) {
  const std::string line = format_request(4, "answer", {{"prompt", 2}, {"text", "two\nlines"}});
  EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1);
  EXPECT_EQ(line.back(), '\n');
  const RpcRequest back = request(line);
  EXPECT_EQ(back.id, "4");
  EXPECT_EQ(back.params.at("text"), "two\nlines");

  const auto result = parse_answer(format_result("\"x\"", {{"rate", 1.5}}));
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(std::get<RpcAnswer>(*result).id, "\"x\"");
  EXPECT_EQ(std::get<nlohmann::json>(std::get<RpcAnswer>(*result).outcome).at("rate"), 1.5);

  const auto error = parse_answer(format_error("null", {RpcCode::kPermission, "n\xff o"}));
  ASSERT_TRUE(error) << error.error().message;
  const auto& said = std::get<RpcError>(std::get<RpcAnswer>(*error).outcome);
  EXPECT_EQ(said.code, RpcCode::kPermission);
  EXPECT_EQ(said.message, "n\xef\xbf\xbd o");

  const auto note = parse_answer(format_notification("status", {{"state", "idle"}}));
  ASSERT_TRUE(note) << note.error().message;
  EXPECT_EQ(std::get<RpcNotification>(*note).params.at("state"), "idle");
}

TEST(JsonRpc, AnswersThatMakeNoSenseAreAnError) {
  for (const char* line :
       {"", "[]", "{}", R"({"jsonrpc":"2.0","id":1})", R"({"jsonrpc":"2.0","result":1})",
        R"({"jsonrpc":"2.0","id":1,"error":{"code":"x","message":"y"}})",
        R"({"jsonrpc":"2.0","id":1,"error":{"code":1}})", R"({"jsonrpc":"2.0","method":"m"})",
        R"({"jsonrpc":"2.0","method":1,"params":{}})"}) {
    const auto answer = parse_answer(line);
    ASSERT_FALSE(answer) << line;
    EXPECT_EQ(answer.error().code, ErrorCode::kProtocol);
  }
}

// Every byte of good requests replaced, cut and doubled, by a fixed seed: nothing but a request or
// a refusal comes out, and the refusal's line can be formatted.
TEST(JsonRpc, SurvivesDamagedLines) {
  const std::string good =
      R"({"jsonrpc":"2.0","id":12,"method":"run","params":{"procedure":"a\u00e9","set":{"x":[1,2e3]}}})";
  std::mt19937 random(20260101);
  std::size_t refused = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string line = good;
    for (auto times = 1 + random() % 4; times > 0; --times) {
      const std::size_t at = random() % line.size();
      switch (random() % 3) {
        case 0:
          line[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          line.erase(at, 1 + random() % 5);
          break;
        default:
          line.insert(at, line.substr(at, random() % 9));
      }
      if (line.empty()) line = "{";
    }
    const auto parsed = parse_request(line);
    if (const auto* refusal = std::get_if<RpcRefusal>(&parsed)) {
      ++refused;
      ASSERT_TRUE(parse_answer(format_error(refusal->id, refusal->error))) << line;
    }
  }
  EXPECT_GT(refused, 10000U);
}

}  // namespace
}  // namespace fogbench::daemon
