// What a person reads when a file is wrong: file, JSON pointer, what was found, what was expected.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/bench.hpp"
#include "config/scenario.hpp"
#include "tests/config/changed_file.hpp"

namespace fogbench::config {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string bench_message(const std::string& patch) {
  ChangedFile file;
  return message_of(load_bench(file.patch("benches/simulated.json", patch)));
}

TEST(Reading, UnknownKeySuggestsTheNearest) {
  EXPECT_EQ(bench_message(R"([{"op": "add", "path": "/gyro/max_gap", "value": 1}])"),
            "changed.json: /gyro/max_gap: unknown key; did you mean \"max_gap_s\"?");
  EXPECT_THAT(bench_message(R"([{"op": "add", "path": "/limits/zzzzzzzz", "value": 1}])"),
              HasSubstr("unknown key; expected one of temperature_minimum_c, "));
}

TEST(Reading, MisspeltKeyIsNamedBeforeTheOneThatIsMissing) {
  EXPECT_EQ(bench_message(R"([{"op": "move", "from": "/name", "path": "/nmae"}])"),
            "changed.json: /nmae: unknown key; did you mean \"name\"?");
}

TEST(Reading, MissingKeyIsExplained) {
  EXPECT_EQ(bench_message(R"([{"op": "remove", "path": "/gyro"}])"),
            "changed.json: has no key \"gyro\"; expected: The gyro under test.");
}

TEST(Reading, WrongTypeSaysWhatWasFoundAndExpected) {
  EXPECT_EQ(bench_message(R"([{"op": "replace", "path": "/limits", "value": [1]}])"),
            "changed.json: /limits: found a list of 1, expected an object");
  EXPECT_EQ(bench_message(R"([{"op": "replace", "path": "/gyro/max_gap_s", "value": "0.1"}])"),
            "changed.json: /gyro/max_gap_s: found \"0.1\", expected a number above 0");
  EXPECT_EQ(bench_message(R"([{"op": "replace", "path": "/turntable/motorised", "value": null}])"),
            "changed.json: /turntable/motorised: found null, expected true or false");
  EXPECT_EQ(bench_message(R"([{"op": "replace", "path": "/simulation/magnetic/ambient_ut",
                               "value": [1, 2]}])"),
            "changed.json: /simulation/magnetic/ambient_ut: found a list of 2, expected a list of "
            "3");
  EXPECT_EQ(bench_message(R"([{"op": "replace", "path": "/name", "value": "a\nb"}])"),
            "changed.json: /name: found \"a?b\", expected a text of one line that is not empty");
}

TEST(Reading, NumberOutsideItsBoundsSaysThem) {
  EXPECT_EQ(bench_message(R"([{"op": "replace", "path": "/simulation/step_s", "value": 11}])"),
            "changed.json: /simulation/step_s: found 11, expected a number from 0.001 to 1");
  EXPECT_EQ(bench_message(R"([{"op": "replace", "path": "/gyro/max_gap_s", "value": 0}])"),
            "changed.json: /gyro/max_gap_s: found 0, expected a number above 0");
}

TEST(Reading, FileThatIsNoObjectIsAnError) {
  ChangedFile file;
  EXPECT_EQ(message_of(load_bench(file.write("[]"))),
            "changed.json: found an empty list, expected an object");
  EXPECT_EQ(message_of(load_scenario(file.write("\"navigation\""))),
            "changed.json: found \"navigation\", expected an object");
}

TEST(Reading, KeyForEditorsIsAllowedAtTheTopOnly) {
  EXPECT_THAT(bench_message(R"([{"op": "add", "path": "/limits/$schema", "value": "x"}])"),
              StartsWith("changed.json: /limits/$schema: unknown key"));
}

TEST(Reading, PointerIsEscapedAsTheStandardSays) {
  EXPECT_THAT(bench_message(R"([{"op": "add", "path": "/a~1b~0c", "value": 1}])"),
              StartsWith("changed.json: /a~1b~0c: unknown key"));
}

}  // namespace
}  // namespace fogbench::config
