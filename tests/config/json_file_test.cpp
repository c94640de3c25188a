#include "config/json_file.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/config/changed_file.hpp"

namespace fogbench::config {
namespace {

std::string parse_message(const std::string& text) {
  return message_of(parse_json(text, "f.json"));
}

TEST(JsonFile, SyntaxErrorNamesLineAndColumn) {
  EXPECT_EQ(parse_message("{\n  \"a\": 1,\n  \"b\" 2\n}").substr(0, 24),
            "f.json: line 3, column 7");
  EXPECT_EQ(parse_message("{\"a\": 1").substr(0, 24), "f.json: line 1, column 8");
  EXPECT_EQ(parse_message("{} x").substr(0, 24), "f.json: line 1, column 4");
}

TEST(JsonFile, KeyThatStandsTwiceIsAnError) {
  EXPECT_EQ(parse_message(R"({"a": [0, {"b": 1, "b": 2}]})"),
            "f.json: /a/1/b: this key stands twice; expected it once");
  EXPECT_TRUE(parse_json(R"([{"b": 1}, {"b": 2}])", "f.json"));
}

TEST(JsonFile, NumbersThatAreNoDoublesAreErrors) {
  EXPECT_NE(parse_message("{\"a\": 1e999}").find("1e999"), std::string::npos);
  EXPECT_NE(parse_message("{\"a\": NaN}").find("line 1"), std::string::npos);
  EXPECT_NE(parse_message("{\"a\": -Infinity}").find("line 1"), std::string::npos);
}

TEST(JsonFile, DeepNestingIsAnError) {
  EXPECT_EQ(parse_message(std::string(100000, '[')), "f.json: nested deeper than 64 levels");
}

TEST(JsonFile, EmptyAndBinaryTextsAreErrorsOfOneLine) {
  EXPECT_EQ(parse_message(""), "f.json: empty; expected a JSON object");
  EXPECT_EQ(parse_message(" \n"), "f.json: empty; expected a JSON object");
  EXPECT_NE(parse_message(std::string("\x7f\x45LF\0\0\n\n\xff", 9)).find("line 1"),
            std::string::npos);
  EXPECT_NE(parse_message("{\"a\": \"\xff\"}").find("line 1"), std::string::npos);
  EXPECT_LT(parse_message("\"" + std::string(1 << 20, 'a')).size(), 300U);
}

TEST(JsonFile, WhatIsNoReadableFileIsAnErrorOfOneLine) {
  EXPECT_EQ(message_of(read_text_file("/no/such/file")), "/no/such/file: no such file");
  EXPECT_EQ(message_of(read_text_file("/tmp")), "/tmp: a directory; expected a file");
  EXPECT_NE(message_of(read_text_file(std::string(5000, 'a'))), "");
}

TEST(JsonFile, FileBeyondTheLimitIsAnError) {
  ChangedFile file;
  file.write("");
  std::filesystem::resize_file(file.path(), (std::uintmax_t{64} << 20) + 1);
  EXPECT_EQ(message_of(read_text_file(file.path())), "changed.json: larger than 64 MiB");
}

TEST(JsonFile, PrettyTextReadsBackExactly) {
  const nlohmann::ordered_json value = {{"third", 1.0 / 3}, {"list", {1, 2.5, 1e-300}}, {"no", {}}};
  const auto back = parse_json(pretty_json(value), "f.json");
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ((*back)["third"].get<double>(), 1.0 / 3);
  EXPECT_EQ((*back)["list"][2].get<double>(), 1e-300);
}

TEST(JsonFile, PrettyTextKeepsShortThingsOnALine) {
  const nlohmann::ordered_json value = {{"b", {1, 2}}, {"a", std::vector<int>(60, 7)}};
  const std::string text = pretty_json(value);
  EXPECT_EQ(text.substr(0, 17), "{\n  \"b\": [1, 2],\n");
  EXPECT_NE(text.find("\n    7,\n"), std::string::npos);
}

TEST(OneLine, QuotesAnythingShortAndPrintable) {
  EXPECT_EQ(one_line("a\nb\x01"), "a?b?");
  EXPECT_EQ(one_line(std::string(100, 'x'), 3), "xxx...");
  EXPECT_EQ(one_line("21 \u00b0C"), "21 \u00b0C");
  EXPECT_EQ(one_line("\xb0 \xff \xe2\x82"), "? ? ??");
  EXPECT_EQ(one_line(""), "");
}

}  // namespace
}  // namespace fogbench::config
