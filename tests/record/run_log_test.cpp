#include "record/run_log.hpp"
#include "procedures/channel_values.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "record/run_log_reader.hpp"
#include "record/store.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fogbench::record {
namespace {

using procedures::Point;
using procedures::PointKind;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

procedures::RunHeader header() {
  procedures::RunHeader header;
  header.procedure = "coil-sweep";
  header.procedure_json = "{\"a\": 1}";
  header.bench = "simulated";
  header.bench_json = "{}";
  header.scenario_json = "{\"noise\": \"none\"}";
  header.seed = 18446744073709551615ULL;
  header.gyro_serial_number = "SN-1";
  header.operator_name = "Ivanov";
  header.software_version = "0.1.0";
  header.started_at = "2026-01-01T00:00:00Z";
  header.frame_rate_hz = 1000.0;
  header.reference_rate_deg_per_h = 12.433;
  return header;
}

Point point(double value) {
  Point point;
  double next = value;
  for (const auto& column : procedures::point_channels()) point.*column.value = next += 1.0 / 3.0;
  return point;
}

class RunLogTest : public testing::Test {
 protected:
  RunLogTest() : path_(folder_ / "store.db") {}

  std::unique_ptr<RunLog> open() const {
    auto log = RunLog::open(path_);
    EXPECT_TRUE(log) << log.error().message;
    return std::move(*log);
  }
  std::unique_ptr<RunLogReader> reader() const {
    auto reader = RunLogReader::open(path_);
    EXPECT_TRUE(reader) << reader.error().message;
    return std::move(*reader);
  }

  support::TemporaryFolder folder_;
  std::filesystem::path path_;
};

TEST_F(RunLogTest, KeepsEveryFieldOfARun) {
  const auto log = open();
  const auto run = log->begin_run(header(), {{"gyro", "KVH", "SN-1", "2025-01-01", "2027-01-01"}});
  ASSERT_TRUE(run);
  EXPECT_EQ(*run, 1);
  procedures::RunEnd end{procedures::RunOutcome::kAborted,
                         "signal",
                         true,
                         "2026-01-01T01:00:00Z",
                         {10, 1, 2, 3, 4, 5}};
  ASSERT_TRUE(log->end_run(end));

  const auto stored = reader()->run(1);
  ASSERT_TRUE(stored);
  EXPECT_EQ(stored->header.procedure, "coil-sweep");
  EXPECT_EQ(stored->header.procedure_json, "{\"a\": 1}");
  EXPECT_EQ(stored->header.bench, "simulated");
  EXPECT_EQ(stored->header.bench_json, "{}");
  EXPECT_EQ(stored->header.scenario_json, "{\"noise\": \"none\"}");
  EXPECT_EQ(stored->header.seed, 18446744073709551615ULL);
  EXPECT_EQ(stored->header.gyro_serial_number, "SN-1");
  EXPECT_EQ(stored->header.operator_name, "Ivanov");
  EXPECT_EQ(stored->header.software_version, "0.1.0");
  EXPECT_EQ(stored->header.started_at, "2026-01-01T00:00:00Z");
  EXPECT_EQ(stored->header.frame_rate_hz, 1000.0);
  EXPECT_EQ(stored->header.reference_rate_deg_per_h, 12.433);
  ASSERT_TRUE(stored->end);
  EXPECT_EQ(stored->outcome(), "aborted");
  EXPECT_EQ(stored->end->reason, "signal");
  EXPECT_TRUE(stored->end->safe_state_reached);
  EXPECT_EQ(stored->end->ended_at, "2026-01-01T01:00:00Z");
  EXPECT_EQ(stored->end->stream.frames_good, 10U);
  EXPECT_EQ(stored->end->stream.frames_bad_checksum, 1U);
  EXPECT_EQ(stored->end->stream.frames_invalid, 2U);
  EXPECT_EQ(stored->end->stream.frames_repeated, 3U);
  EXPECT_EQ(stored->end->stream.frames_missing, 4U);
  EXPECT_EQ(stored->end->stream.bytes_skipped, 5U);
  EXPECT_EQ(stored->raw_sha256.size(), 64U);

  const auto instruments = reader()->instruments(1);
  ASSERT_TRUE(instruments);
  ASSERT_EQ(instruments->size(), 1U);
  EXPECT_EQ(instruments->front().identity, "KVH");
  EXPECT_EQ(instruments->front().calibration_due, "2027-01-01");
}

TEST_F(RunLogTest, KeepsEveryFieldOfAPoint) {
  const auto log = open();
  ASSERT_TRUE(log->begin_run(header(), {}));
  Point written = point(0.1);
  written.kind = PointKind::kTransient;
  written.test = 2;
  written.block = 3;
  written.segment = "coil_z/down, \"odd\"";
  written.count = 60000;
  written.dropped = 7;
  ASSERT_TRUE(log->point(written));

  const auto points = reader()->points(1);
  ASSERT_TRUE(points);
  ASSERT_EQ(points->size(), 1U);
  const Point& read = points->front().point;
  EXPECT_EQ(read.kind, PointKind::kTransient);
  EXPECT_EQ(read.test, 2);
  EXPECT_EQ(read.block, 3);
  EXPECT_EQ(read.segment, written.segment);
  EXPECT_EQ(read.count, 60000U);
  EXPECT_EQ(read.dropped, 7U);
  for (const auto& column : procedures::point_channels()) {
    EXPECT_EQ(read.*column.value, written.*column.value) << column.name;
  }
}

TEST_F(RunLogTest, AuxiliaryChannelsGetColumnsOfTheirOwn) {
  const auto log = open();
  ASSERT_TRUE(log->begin_run(header(), {}));
  ASSERT_TRUE(log->point(point(1.0)));
  procedures::RunHeader with = header();
  with.auxiliary = {{"pressure_hpa", "air pressure"}, {"supply_v", ""}};
  ASSERT_TRUE(log->begin_run(with, {}));
  Point written = point(2.0);
  written.auxiliary = {{"pressure_hpa", 1013.25}, {"supply_v", kNaN}};
  ASSERT_TRUE(log->point(written));
  // A store that has them already takes another run with them, and one without.
  ASSERT_TRUE(log->begin_run(with, {}));
  ASSERT_TRUE(log->begin_run(header(), {}));
  ASSERT_TRUE(log->point(point(3.0)));

  const auto points = reader()->points(2);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(points->front().point.auxiliary,
            (procedures::AuxiliaryValues{{"pressure_hpa", 1013.25}}));
  for (const std::int64_t run : {1, 4}) {
    const auto others = reader()->points(run);
    ASSERT_TRUE(others) << others.error().message;
    EXPECT_TRUE(others->front().point.auxiliary.empty());
  }
}

TEST_F(RunLogTest, MissingQuantitiesComeBackMissing) {
  const auto log = open();
  ASSERT_TRUE(log->begin_run(header(), {}));
  Point written = point(1.0);
  written.field_set_ut = kNaN;
  ASSERT_TRUE(log->point(written));
  const auto points = reader()->points(1);
  ASSERT_TRUE(points);
  EXPECT_TRUE(std::isnan(points->front().point.field_set_ut));
  EXPECT_FALSE(std::isnan(points->front().point.field_x_ut));
}

TEST_F(RunLogTest, APointIsOnDiskWhenTheCallReturns) {
  const auto log = open();
  ASSERT_TRUE(log->begin_run(header(), {}));
  for (int i = 1; i <= 3; ++i) {
    ASSERT_TRUE(log->point(point(i)));
    // Another connection, as a process that opens the store after this one was killed.
    const auto points = reader()->points(1);
    ASSERT_TRUE(points);
    EXPECT_EQ(points->size(), static_cast<std::size_t>(i));
  }
}

TEST_F(RunLogTest, ARunWithoutAnEndIsInterrupted) {
  { ASSERT_TRUE(open()->begin_run(header(), {})); }
  const auto runs = reader()->runs();
  ASSERT_TRUE(runs);
  ASSERT_EQ(runs->size(), 1U);
  EXPECT_EQ(runs->front().outcome(), "interrupted");
  EXPECT_FALSE(runs->front().completed());
}

TEST_F(RunLogTest, ARunThatSomebodyWritesIsUnderWay) {
  const auto log = open();
  ASSERT_TRUE(log->begin_run(header(), {}));
  EXPECT_EQ(reader()->runs()->front().outcome(), "under way");
  EXPECT_EQ(reader()->run(1)->outcome(), "under way");
  ASSERT_TRUE(log->end_run({}));
  EXPECT_EQ(reader()->run(1)->outcome(), "completed");
}

TEST_F(RunLogTest, RunsAreNumberedOneAfterTheOther) {
  ASSERT_TRUE(open()->begin_run(header(), {}));
  const auto second = open()->begin_run(header(), {});
  ASSERT_TRUE(second);
  EXPECT_EQ(*second, 2);
}

TEST_F(RunLogTest, VoidsTheValidPointsOfOneBlockAndSaysSo) {
  const auto log = open();
  ASSERT_TRUE(log->begin_run(header(), {}));
  for (const int block : {0, 1, 1, 2}) {
    Point written = point(1.0);
    written.block = block;
    ASSERT_TRUE(log->point(written));
  }
  ASSERT_TRUE(log->void_block(1, 12.0, "paused"));
  const auto points = reader()->points(1);
  ASSERT_TRUE(points);
  std::vector<std::string> reasons;
  for (const StoredPoint& stored : *points) reasons.push_back(stored.void_because);
  EXPECT_EQ(reasons, (std::vector<std::string>{"", "paused", "paused", ""}));
  const auto events = reader()->events(1);
  ASSERT_TRUE(events);
  ASSERT_EQ(events->size(), 1U);
  EXPECT_NE(events->front().message.find("paused"), std::string::npos);
}

TEST_F(RunLogTest, KeepsStepsWithTheirEvidenceAndEventsWithTheirData) {
  const auto log = open();
  ASSERT_TRUE(log->begin_run(header(), {}));
  ASSERT_TRUE(log->step_started("1", "heat to 31 degC", 1.5));
  procedures::MonitorRow row;
  ASSERT_TRUE(log->monitor(row));
  ASSERT_TRUE(log->event(2.0, "warning", "late answer", "{\"after_s\": 1}"));
  ASSERT_TRUE(log->step_ended("1", 3.5, "slope 0.1 degC/h"));
  ASSERT_TRUE(log->step_started("2", "average", 3.5));
  const auto steps = reader()->steps(1);
  ASSERT_TRUE(steps);
  ASSERT_EQ(steps->size(), 2U);
  EXPECT_EQ(steps->front().says, "heat to 31 degC");
  EXPECT_EQ(steps->front().started_s, 1.5);
  EXPECT_EQ(steps->front().ended_s, 3.5);
  EXPECT_EQ(steps->front().evidence, "slope 0.1 degC/h");
  EXPECT_TRUE(std::isnan(steps->back().ended_s));
  const auto events = reader()->events(1);
  ASSERT_TRUE(events);
  ASSERT_EQ(events->size(), 1U);
  EXPECT_EQ(events->front().severity, "warning");
  EXPECT_EQ(events->front().message, "late answer");
  EXPECT_EQ(events->front().data_json, "{\"after_s\": 1}");
}

TEST_F(RunLogTest, KeepsWhatHappensOutsideOfRuns) {
  EXPECT_TRUE(open()->bench_event("bench 2", {1e9 + 0.25, "warning", "refused", "", ""}));
  auto log = open();
  ASSERT_TRUE(log->begin_run(header(), {}));
  EXPECT_TRUE(log->bench_event("bench 1", {1e9 + 1.0, "info", "queued", "SN-1", R"({"job":1})"}));
  const auto events = reader()->bench_events();
  ASSERT_TRUE(events) << events.error().message;
  ASSERT_EQ(events->size(), 2U);
  EXPECT_EQ((*events)[0].bench, "bench 2");
  EXPECT_EQ((*events)[0].unix_s, 1e9 + 0.25);
  EXPECT_EQ((*events)[0].severity, "warning");
  EXPECT_EQ((*events)[1].message, "queued");
  EXPECT_EQ((*events)[1].gyro_serial_number, "SN-1");
  EXPECT_EQ((*events)[1].data_json, R"({"job":1})");
  EXPECT_TRUE(reader()->events(1)->empty()) << "they are no run's";
}

TEST_F(RunLogTest, AnOlderLogHasNothingOutsideOfRuns) {
  open();
  auto database = Database::open(path_, Database::Mode::kWrite);
  ASSERT_TRUE((*database)->execute("DROP TABLE bench_events"));
  EXPECT_TRUE(reader()->bench_events()->empty());
  EXPECT_TRUE(open()->bench_event("bench", {0.0, "info", "is added", "", ""}));
  EXPECT_EQ(reader()->bench_events()->size(), 1U);
}

TEST_F(RunLogTest, MonitorRowsAreKeptToTheLast) {
  const auto log = open();
  ASSERT_TRUE(log->begin_run(header(), {}));
  procedures::MonitorRow row;
  row.thermostat.mode = config::HeatingMode::kBoost;
  for (int i = 0; i < 1000; ++i) {
    row.time_s = i;
    row.thermostat.working_1 = config::Celsius{21.0 + i};
    ASSERT_TRUE(log->monitor(row));
  }
  ASSERT_TRUE(log->end_run({}));
  const auto store = open_store(path_);
  ASSERT_TRUE(store);
  EXPECT_EQ(*(*store)->integer("SELECT count(*) FROM monitor"), 1000);
  EXPECT_EQ(*(*store)->integer("SELECT count(*) FROM monitor WHERE mode = 'boost' AND "
                               "temperature_working_1_c = 21.0 + time_s"),
            1000);
}

TEST_F(RunLogTest, TheRawStreamComesBackWhole) {
  const auto log = open();
  ASSERT_TRUE(log->begin_run(header(), {}));
  drivers::GyroBlock all, block;
  std::int64_t index = 0;
  for (int i = 0; i < 1500; ++i) {  // more than two chunks, in pieces that do not divide them
    block.clear();
    for (int k = 0; k < 97; ++k) {
      block.index.push_back(index += i == 700 ? 2 : 1);
      block.rate_deg_per_h.push_back(static_cast<float>(index) * 0.25F);
      block.temperature_c.push_back(21.0F);
    }
    ASSERT_TRUE(log->gyro_samples(block));
    all.index.insert(all.index.end(), block.index.begin(), block.index.end());
    all.rate_deg_per_h.insert(all.rate_deg_per_h.end(), block.rate_deg_per_h.begin(),
                              block.rate_deg_per_h.end());
  }
  ASSERT_TRUE(log->end_run({}));

  drivers::GyroBlock read;
  int chunks = 0;
  const Status status = reader()->read_gyro(1, [&](const drivers::GyroBlock& chunk) -> Status {
    ++chunks;
    read.index.insert(read.index.end(), chunk.index.begin(), chunk.index.end());
    read.rate_deg_per_h.insert(read.rate_deg_per_h.end(), chunk.rate_deg_per_h.begin(),
                               chunk.rate_deg_per_h.end());
    return {};
  });
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(chunks, 3);
  EXPECT_EQ(read.index, all.index);
  EXPECT_EQ(read.rate_deg_per_h, all.rate_deg_per_h);
  EXPECT_EQ(reader()->run(1)->frames_stored, 1500 * 97);
}

TEST_F(RunLogTest, OneSampleMakesAnotherHash) {
  const auto log = open();
  for (const float rate : {1.0F, 1.0F, std::nextafter(1.0F, 2.0F)}) {
    ASSERT_TRUE(log->begin_run(header(), {}));
    drivers::GyroBlock block;
    block.index = {0};
    block.rate_deg_per_h = {rate};
    ASSERT_TRUE(log->gyro_samples(block));
    ASSERT_TRUE(log->end_run({}));
  }
  const auto runs = reader()->runs();
  ASSERT_TRUE(runs);
  EXPECT_EQ((*runs)[0].raw_sha256, (*runs)[1].raw_sha256);
  EXPECT_NE((*runs)[0].raw_sha256, (*runs)[2].raw_sha256);
}

TEST_F(RunLogTest, ADamagedOrMissingChunkIsNamed) {
  const auto log = open();
  ASSERT_TRUE(log->begin_run(header(), {}));
  drivers::GyroBlock block;
  for (std::int64_t i = 0; i < 3 * 65536; ++i) {
    block.index.push_back(i);
    block.rate_deg_per_h.push_back(1.0F);
  }
  ASSERT_TRUE(log->gyro_samples(block));
  const auto ignore = [](const drivers::GyroBlock&) -> Status { return {}; };

  const auto store = open_store_for_writing(path_);
  ASSERT_TRUE(store);
  ASSERT_TRUE((*store)->execute("UPDATE gyro_chunks SET first_index = 1 WHERE chunk = 1"));
  Status status = reader()->read_gyro(1, ignore);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("run 1, chunk 1: damaged"), std::string::npos);
  ASSERT_TRUE((*store)->execute("DELETE FROM gyro_chunks WHERE chunk = 1"));
  status = reader()->read_gyro(1, ignore);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("chunk 2: a chunk before it is missing"),
            std::string::npos);
}

TEST_F(RunLogTest, AnUnknownRunIsBadInputThatNamesTheLastOne) {
  ASSERT_TRUE(open()->begin_run(header(), {}));
  const auto run = reader()->run(9);
  ASSERT_FALSE(run);
  EXPECT_EQ(run.error().code, ErrorCode::kBadInput);
  EXPECT_NE(run.error().message.find("no run 9: its last run is 1"), std::string::npos);
}

}  // namespace
}  // namespace fogbench::record
