// fogbench history, run as its users run it: what happened on a bench, by the calendar.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "tests/system/fogbench.hpp"

namespace fogbench::system_tests {
namespace {

using ::testing::HasSubstr;

class HistoryTest : public FogbenchTest {
 protected:
  /// A run of five minutes in which the barometer is gone for one.
  void run(const std::string& gyro) {
    const auto scenario = folder_.file("scenario.json", R"({"name": "gone", "noise": "navigation",
      "faults": [{"device": "barometer", "kind": "unplug", "at_s": 60, "for_s": 60}]})");
    const auto done = support::run(dry_run(
        {"static-record"}, {"--bench", "simulated-auxiliary", "--scenario", scenario.string(),
                            "--gyro", gyro, "--seed", "1", "--set", "duration_s=300"}));
    ASSERT_EQ(done.status, 0) << done.err;
  }
  std::vector<std::string> history(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"history", "--store", store()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

TEST_F(HistoryTest, SaysWhatHappenedInTheOrderOfTheCalendar) {
  run("FOG-1");
  run("FOG-2");
  const auto done = fogbench(history());
  ASSERT_EQ(done.status, 0) << done.err;
  std::size_t at = 0;
  for (const char* says :
       {"run 1 begins: static-record, gyro FOG-1, bench simulated-auxiliary",
        "warning: barometer: unplugged; its channels are missing until it answers, the run goes on",
        "barometer: answers again after", "run 1 completed after 5 min"}) {
    const std::size_t next = done.out.find(says, at);
    ASSERT_NE(next, std::string::npos) << says << " in\n" << done.out;
    at = next;
  }
  EXPECT_THAT(done.out, HasSubstr("5 points; coils and heaters off, read back"));
  EXPECT_TRUE(std::regex_search(done.out, std::regex("^20[0-9]{2}-[0-9]{2}-[0-9]{2}, UTC\n")));
}

TEST_F(HistoryTest, KeepsToOneGyroAndToATime) {
  run("FOG-1");
  run("FOG-2");
  const auto of_one = json(history({"--gyro", "FOG-2", "--json"}))["history"];
  ASSERT_GE(of_one.size(), 4U);
  for (const auto& one : of_one) EXPECT_EQ(one["gyro_serial_number"], "FOG-2") << one;
  EXPECT_EQ(fogbench(history({"--since", "2099-01-01"})).out, "Nothing is on record.\n");
  EXPECT_EQ(json(history({"--since", "1d", "--json"}))["history"].size(),
            json(history({"--json"}))["history"].size());
  expect_refused(fogbench(history({"--since", "yesterday"})), 2, "--since: found \"yesterday\"");
}

TEST_F(HistoryTest, WritesAPageThatEscapesWhatPeopleWrote) {
  run("<FOG & 1>");
  const auto page = folder_ / "history.html";
  ASSERT_EQ(fogbench(history({"--html", page.string()})).status, 0);
  const std::string html = support::read_text(page);
  EXPECT_THAT(html, HasSubstr("&lt;FOG &amp; 1&gt;"));
  EXPECT_EQ(html.find("<FOG"), std::string::npos);
}

TEST_F(HistoryTest, ShowDatesItsEventsToo) {
  run("FOG-1");
  const auto shown = json({"show", "1", "--store", store(), "--json"});
  ASSERT_FALSE(shown["events"].empty());
  EXPECT_EQ(shown["events"][0]["at"].get<std::string>().size(), 20U) << shown["events"][0];
  EXPECT_THAT(fogbench({"show", "1", "--store", store()}).out,
              HasSubstr("Events, by date and by time since power-on"));
}

}  // namespace
}  // namespace fogbench::system_tests
