#include "cli/status_text.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace fogbench::cli {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

/// A run that began when the gyro had been on for two hours.
json running() {
  return {{"state", "running"},
          {"run",
           {{"run", 7},
            {"procedure", "coil-sweep"},
            {"by", "alice"},
            {"step", 5},
            {"steps", 82},
            {"says", "average"},
            {"started_s", 7200.0},
            {"elapsed_s", 180.0},
            {"remaining_s", 600.0},
            {"points", 2},
            {"waiting", nullptr},
            {"pause_requested", false},
            {"pauses_after", false}}},
          {"values", {{"time_s", 7379.5}, {"ambient_c", 21.0}, {"field_x_ut", 50.0}}},
          {"values_age_s", 0.5},
          {"old_values", json::object()},
          {"queue", {{"jobs", 0}, {"held", false}, {"because", ""}}}};
}

TEST(StatusText, HasOneClockWhichBeginsWithTheRun) {
  json status = running();
  status["events"] =
      json::array({{{"time_s", 7260.0}, {"severity", "info"}, {"message", "resumed"}}});
  status["point"] = {{"segment", "coil_x/up"}, {"time_s", 7320.0}, {"rate_deg_per_h", 0.5}};
  const std::string text = status_text(status);
  EXPECT_THAT(text, HasSubstr("3 min so far"));
  EXPECT_THAT(text, HasSubstr("coil_x/up, 2 min after the start, 0.5000 deg/h"));
  EXPECT_THAT(text, HasSubstr("       1 min  info     resumed"));
  EXPECT_THAT(text, Not(HasSubstr("7260")));
}

TEST(StatusText, SaysHowOldAValueIs) {
  json status = running();
  EXPECT_THAT(status_text(status), Not(HasSubstr("old")));
  status["values"]["ambient_c"] = nullptr;
  status["values"]["field_x_ut"] = nullptr;
  status["old_values"]["ambient_c"] = {{"value", 20.5}, {"age_s", 45.2}};
  EXPECT_THAT(status_text(status), HasSubstr("20.500 degC, 45 s old"));
  EXPECT_THAT(status_text(status), HasSubstr("- uT")) << "it was never read";
  status["values_age_s"] = 90.0;
  EXPECT_THAT(status_text(status), HasSubstr("read last, 1 min 30 s old:"));
}

TEST(StatusText, CountsDownWhileItWaits) {
  json status = running();
  status["run"]["waiting"] = {{"for_s", 600.0}, {"at_most_s", 43200.0}};
  EXPECT_THAT(status_text(status),
              HasSubstr("it has waited for 10 min; the run fails in 11 h 50 min"));
}

TEST(StatusText, SaysWhenAPauseComes) {
  json status = running();
  status["run"]["pause_requested"] = true;
  EXPECT_THAT(status_text(status), HasSubstr("before the next divisible step"));
  status["run"]["pauses_after"] = true;
  EXPECT_THAT(status_text(status), HasSubstr("the queue is held after the run"));
}

TEST(StatusText, OffersOnlyWhatCanBeDone) {
  json status{
      {"state", "idle"},
      {"run", nullptr},
      {"last_run", {{"run", 7}, {"procedure", "p"}, {"outcome", "failed"}, {"resumable", true}}},
      {"interrupted", {{"run", 5}, {"procedure", "my p"}, {"points", 31}, {"obstacle", nullptr}}},
      {"queue", {{"jobs", 0}, {"held", true}, {"because", "asked for by bob"}}}};
  EXPECT_THAT(status_text(status), HasSubstr("(fogbench resume 7 takes it up)"));
  EXPECT_THAT(status_text(status), HasSubstr("fogbench resume 5 takes it up"));
  EXPECT_THAT(status_text(status), HasSubstr("the queue is held: asked for by bob"));
  status["last_run"]["resumable"] = false;
  status["interrupted"]["obstacle"] = "the bench is another";
  const std::string text = status_text(status);
  EXPECT_THAT(text, Not(HasSubstr("takes it up")));
  EXPECT_THAT(text, HasSubstr("the bench is another\nfogbench resume 5 --discard gives it up, "
                              "fogbench run 'my p' begins it anew\n"));
}

}  // namespace
}  // namespace fogbench::cli
