#include "daemon/bench_difference.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace fogbench::daemon {
namespace {

using nlohmann::json;

std::string record(const json& bench, const json& device = {{"type", "gyro"}}) {
  return json{{"bench.json", bench.dump()}, {"gyro.json", device.dump(2)}}.dump();
}

TEST(BenchDifference, NamesFileKeyAndBothValues) {
  const json bench{{"limits", {{"field_maximum_ut", 320}}}, {"name", "b"}};
  json other = bench;
  other["limits"]["field_maximum_ut"] = 300;
  EXPECT_EQ(bench_difference(record(bench), record(other)),
            "bench.json: /limits/field_maximum_ut was 320, is 300");
  other = bench;
  other["limits"]["new"] = true;
  EXPECT_EQ(bench_difference(record(bench), record(other)), "bench.json: /limits/new is new: true");
  EXPECT_EQ(bench_difference(record(other), record(bench)), "bench.json: /limits/new is gone");
  EXPECT_EQ(bench_difference(record(bench), record(bench, {{"type", "fog"}})),
            R"(gyro.json: /type was "gyro", is "fog")");
}

TEST(BenchDifference, IsNoneWhereOnlyTheLettersDiffer) {
  const json bench{{"name", "b"}};
  const std::string plain = record(bench);
  EXPECT_EQ(bench_difference(plain, plain), "");
  EXPECT_EQ(bench_difference(plain, json::parse(plain).dump(4)), "");
}

TEST(BenchDifference, SaysTheFirstFewOfMany) {
  json bench, other;
  for (const char* key : {"a", "b", "c", "d", "e"}) {
    bench[key] = 1;
    other[key] = 2;
  }
  EXPECT_EQ(bench_difference(record(bench), record(other)),
            "bench.json: /a was 1, is 2; bench.json: /b was 1, is 2; bench.json: /c was 1, is 2 "
            "and 2 more changes");
}

TEST(BenchDifference, FilesComeAndGoAndRecordsAreDamaged) {
  const std::string one = json{{"bench.json", "{}"}}.dump();
  const std::string two = json{{"bench.json", "{}"}, {"coil.json", "{}"}}.dump();
  EXPECT_EQ(bench_difference(one, two), "coil.json is new");
  EXPECT_EQ(bench_difference(two, one), "coil.json is gone");
  EXPECT_EQ(bench_difference(one, json{{"bench.json", "{"}}.dump()), "bench.json is another");
  EXPECT_EQ(bench_difference("[]", one), "the record of the bench's files is damaged");
}

}  // namespace
}  // namespace fogbench::daemon
