// The text against a strict reader of the exposition format 0.0.4, which shares nothing with the
// writer: https://prometheus.io/docs/instrumenting/exposition_formats/

#include "daemon/metrics.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "procedures/channel_values.hpp"
#include "record/store.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::daemon {
namespace {

using testing::HasSubstr;

/// What a scraper sees: value by series.
using Samples = std::map<std::string, double>;

/// A failure of the test for whatever the format does not allow.
Samples read_metrics(const std::string& text) {
  static const std::regex kHelp("# HELP (fogbench_[a-z0-9_]+) [^ ].*");
  static const std::regex kType("# TYPE (fogbench_[a-z0-9_]+) (gauge|counter)");
  static const std::regex kSample(
      R"re((fogbench_[a-z0-9_]+)(\{[a-z_]+="(?:[^"\\]|\\["\\n])*"\})? (\S+))re");
  Samples samples;
  std::set<std::string> families;
  std::string helped, family, type;
  EXPECT_TRUE(text.empty() || text.back() == '\n') << "the last line has no end";
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, kHelp)) {
      helped = match[1];
      EXPECT_TRUE(families.insert(helped).second) << "a family in two places: " << line;
    } else if (std::regex_match(line, match, kType)) {
      EXPECT_EQ(match[1], helped) << line;
      family = match[1];
      type = match[2];
      EXPECT_EQ(type == "counter", family.ends_with("_total")) << line;
    } else if (std::regex_match(line, match, kSample)) {
      EXPECT_EQ(match[1], family) << "no family of its own: " << line;
      char* end = nullptr;
      const std::string number = match[3];
      const double value = std::strtod(number.c_str(), &end);
      EXPECT_EQ(*end, '\0') << line;
      EXPECT_TRUE(std::isfinite(value)) << line;
      EXPECT_TRUE(type == "gauge" || value >= 0.0) << line;
      EXPECT_TRUE(samples.emplace(match[1].str() + match[2].str(), value).second)
          << "twice: " << line;
    } else {
      ADD_FAILURE() << "not of the format: " << line;
    }
  }
  return samples;
}

DeskView running() {
  DeskView view;
  PresentRun run;
  run.run = 7;
  run.procedure = "coil-sweep";
  run.progress = {procedures::RunState::kRunning, 4, 82, "set", config::Seconds{480.2},
                  config::Seconds{13849.0}};
  run.points = 2;
  view.run = run;
  procedures::MonitorRow row;
  row.thermostat.working_1 = config::Celsius{21.01};
  row.thermostat.ambient = config::Celsius{std::numeric_limits<double>::quiet_NaN()};
  row.current_horizontal_a = -0.25;
  view.values = row;
  view.jobs = 3;
  view.totals.events["warning"] = 2;
  view.totals.stream.frames_good = 1234567;
  view.totals.stream.frames_missing = 5;
  return view;
}

TEST(Metrics, SayWhatARunIsDoing) {
  ControlTotals control;
  control.started_unix_s = 1795343400.125;
  control.connections = 12;
  control.connections_refused = 1;
  control.requests["status"] = 40;
  control.refusals["-32001"] = 3;
  const std::string text = metrics_text("simulated", running(), control);
  EXPECT_THAT(text, HasSubstr("fogbench_build_info{version=\""));
  const Samples samples = read_metrics(text);
  const Samples expected{{"fogbench_up", 1},
                         {"fogbench_bench_info{bench=\"simulated\"}", 1},
                         {"fogbench_start_time_seconds", 1795343400.125},
                         {"fogbench_state{state=\"idle\"}", 0},
                         {"fogbench_state{state=\"running\"}", 1},
                         {"fogbench_run", 7},
                         {"fogbench_run_step", 5},
                         {"fogbench_run_steps", 82},
                         {"fogbench_run_points", 2},
                         {"fogbench_run_remaining_seconds", 13849},
                         {"fogbench_queue_jobs", 3},
                         {"fogbench_temperature_working_1_c", 21.01},
                         {"fogbench_current_horizontal_a", -0.25},
                         {"fogbench_events_total{severity=\"warning\"}", 2},
                         {"fogbench_events_total{severity=\"error\"}", 0},
                         {"fogbench_gyro_frames_total{result=\"good\"}", 1234567},
                         {"fogbench_gyro_frames_total{result=\"missing\"}", 5},
                         {"fogbench_control_connections", 12},
                         {"fogbench_control_connections_refused_total", 1},
                         {"fogbench_control_requests_total{method=\"status\"}", 40},
                         {"fogbench_control_refusals_total{code=\"-32001\"}", 3}};
  for (const auto& [series, value] : expected) {
    ASSERT_TRUE(samples.contains(series)) << series;
    EXPECT_EQ(samples.at(series), value) << series;
  }
  EXPECT_FALSE(samples.contains("fogbench_ambient_c")) << "nobody read it";
  EXPECT_FALSE(samples.contains("fogbench_last_run")) << "none has ended";
}

TEST(Metrics, OldValuesGoWithTheRun) {
  DeskView view = running();
  EndedRun ended;
  ended.run = 7;
  ended.outcome = "aborted";
  view.run.reset();
  view.last_run = ended;
  view.totals.runs["aborted"] = 1;
  const Samples samples = read_metrics(metrics_text("simulated", view, {}));
  EXPECT_EQ(samples.at("fogbench_state{state=\"idle\"}"), 1);
  EXPECT_FALSE(samples.contains("fogbench_temperature_working_1_c"));
  EXPECT_FALSE(samples.contains("fogbench_run_step"));
  EXPECT_EQ(samples.at("fogbench_last_run"), 7);
  EXPECT_EQ(samples.at("fogbench_last_run_safe"), 1);
  EXPECT_EQ(samples.at("fogbench_last_run_outcome{outcome=\"aborted\"}"), 1);
  EXPECT_EQ(samples.at("fogbench_last_run_outcome{outcome=\"completed\"}"), 0);
  EXPECT_EQ(samples.at("fogbench_runs_total{outcome=\"aborted\"}"), 1);
}

TEST(Metrics, ANameMayHoldAnything) {
  const Samples samples = read_metrics(metrics_text("a \"b\" \\ {c}\nd", {}, {}));
  EXPECT_TRUE(samples.contains(R"(fogbench_bench_info{bench="a \"b\" \\ {c}\nd"})"));
}

TEST(Metrics, EveryValueOfTheRunLogIsAMetric) {
  const std::string text = metrics_text("simulated", running(), {});
  for (const auto& column : procedures::monitor_channels()) {
    if (column.name == "time_s" || std::isnan(column.value(*running().values))) continue;
    EXPECT_THAT(text, HasSubstr(fmt::format("\nfogbench_{} ", column.name)));
  }
}

TEST(MetricsFile, HoldsTheLastTextAndGoesWithTheDaemon) {
  const support::TemporaryFolder folder;
  const auto path = folder / "fogbench.prom";
  drivers::VirtualClock clock;
  {
    const auto file = MetricsFile::open(path, clock);
    ASSERT_TRUE(file) << file.error().message;
    (*file)->update([] { return "first\n"; });
    EXPECT_EQ(support::read_text(path), "first\n");
    (*file)->update([] { return "too early\n"; });
    EXPECT_EQ(support::read_text(path), "first\n");
    clock.sleep_for(MetricsFile::kEvery);
    (*file)->update([] { return "second\n"; });
    EXPECT_EQ(support::read_text(path), "second\n");
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(MetricsFile, OutlivesAFolderThatIsGoneForAWhile) {
  const support::TemporaryFolder folder;
  const auto there = folder / "there";
  drivers::VirtualClock clock;
  EXPECT_EQ(MetricsFile::open(there / "fogbench.prom", clock).error().code, ErrorCode::kBadInput);
  std::filesystem::create_directory(there);
  const auto file = MetricsFile::open(there / "fogbench.prom", clock);
  ASSERT_TRUE(file) << file.error().message;
  std::filesystem::remove_all(there);
  (*file)->update([] { return "lost\n"; });
  std::filesystem::create_directory(there);
  clock.sleep_for(MetricsFile::kEvery);
  (*file)->update([] { return "back\n"; });
  EXPECT_EQ(support::read_text(there / "fogbench.prom"), "back\n");
}

TEST(MetricsFile, IsNoneWithoutAPath) {
  drivers::VirtualClock clock;
  const auto file = MetricsFile::open("", clock);
  ASSERT_TRUE(file) << file.error().message;
  (*file)->update([]() -> std::string {
    ADD_FAILURE() << "nobody asked for it";
    return {};
  });
}

}  // namespace
}  // namespace fogbench::daemon
