#include "record/run_log_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "procedures/channel_values.hpp"
#include "record/chunk_codec.hpp"
#include "record/store.hpp"
#include "record/writing_lock.hpp"

namespace fogbench::record {
namespace fs = std::filesystem;
using procedures::InstrumentRecord;
using procedures::Point;
using procedures::PointKind;
using procedures::RunEnd;
using procedures::RunHeader;
using procedures::RunOutcome;

namespace {

constexpr auto kSelectRuns =
    "SELECT run, procedure, procedure_json, bench, bench_json, scenario_json, seed, "
    "gyro_serial_number, operator_name, software_version, started_at, frame_rate_hz, "
    "reference_rate_deg_per_h, "
    "outcome, reason, safe_state_reached, ended_at, frames_good, frames_bad_checksum, "
    "frames_invalid, frames_repeated, frames_missing, bytes_skipped, raw_sha256, "
    "(SELECT count(*) FROM points WHERE points.run = runs.run), "
    "(SELECT count(void_because) FROM points WHERE points.run = runs.run), "
    "(SELECT coalesce(sum(frames), 0) FROM gyro_chunks WHERE gyro_chunks.run = runs.run), {} "
    "FROM runs";

constexpr auto kContinuation =
    "continues, continues_at, "
    "(SELECT coalesce(max(later.run), 0) FROM runs AS later WHERE later.continues = runs.run)";
constexpr auto kNoContinuation = "NULL, NULL, 0";

/// The enumerator of that name; the last one for a name that this version does not know.
template <class Enum, std::size_t N>
Enum parse(const std::string& name, const Enum (&values)[N]) {
  for (const Enum value : values) {
    if (name_of(value) == name) return value;
  }
  return values[N - 1];
}

constexpr RunOutcome kOutcomes[] = {RunOutcome::kCompleted, RunOutcome::kAborted,
                                    RunOutcome::kFailed, RunOutcome::kInterrupted};
constexpr PointKind kPointKinds[] = {PointKind::kBaseline, PointKind::kAverage,
                                     PointKind::kTransient};

StoredRun read_run(const Statement& row) {
  int column = 0;
  const auto text = [&] { return row.text(column++); };
  const auto real = [&] { return row.real(column++); };
  const auto count = [&] { return static_cast<std::uint64_t>(row.integer(column++)); };

  StoredRun stored;
  stored.run = row.integer(column++);
  RunHeader& header = stored.header;
  header.procedure = text();
  header.procedure_json = text();
  header.bench = text();
  header.bench_json = text();
  header.scenario_json = text();
  if (const std::string digits = text(); !digits.empty()) {
    std::uint64_t seed = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), seed);
    header.seed = seed;
  }
  header.gyro_serial_number = text();
  header.operator_name = text();
  header.software_version = text();
  header.started_at = text();
  header.frame_rate_hz = real();
  header.reference_rate_deg_per_h = real();

  const bool ended = !row.is_null(column);
  RunEnd end;
  end.outcome = parse(text(), kOutcomes);
  end.reason = text();
  end.safe_state_reached = row.integer(column++) != 0;
  end.ended_at = text();
  drivers::StreamStatistics& stream = end.stream;
  for (std::uint64_t* counter :
       {&stream.frames_good, &stream.frames_bad_checksum, &stream.frames_invalid,
        &stream.frames_repeated, &stream.frames_missing, &stream.bytes_skipped}) {
    *counter = count();
  }
  if (ended) stored.end = std::move(end);
  stored.raw_sha256 = text();
  stored.points = row.integer(column++);
  stored.points_void = row.integer(column++);
  stored.frames_stored = row.integer(column++);
  if (!row.is_null(column)) {
    header.continues.emplace();
    header.continues->run = row.integer(column);
    header.continues->first_step = row.text(column + 1);
  }
  stored.taken_up_by = row.integer(column + 2);
  return stored;
}

/// Every row of a statement that is bound already.
template <class T, class Read>
Result<std::vector<T>> collect(Statement& statement, Read read) {
  std::vector<T> rows;
  while (true) {
    const auto row = statement.step();
    if (!row) return row.error();
    if (!*row) return rows;
    rows.push_back(read());
  }
}

}  // namespace

std::string StoredRun::outcome() const {
  if (!end) return under_way ? "under way" : "interrupted";
  return std::string(name_of(end->outcome));
}

RunLogReader::RunLogReader(std::unique_ptr<Database> database, fs::path path)
    : database_(std::move(database)), path_(std::move(path)) {}

Result<std::unique_ptr<RunLogReader>> RunLogReader::open(const fs::path& path) {
  auto database = open_store(path);
  if (!database) return database.error();
  std::unique_ptr<RunLogReader> reader(new RunLogReader(std::move(*database), path));
  const auto known = reader->database_->integer(
      "SELECT count(*) FROM pragma_table_info('runs') WHERE name = 'continues'");
  if (!known) return known.error();
  reader->has_continuations_ = *known != 0;
  return reader;
}

std::string RunLogReader::select_runs() const {
  return fmt::format(kSelectRuns, has_continuations_ ? kContinuation : kNoContinuation);
}

StoredRun RunLogReader::read(const Statement& row) const {
  const bool written = WritingLock::held(path_, row.integer(0));  // before its record: it may end
  StoredRun stored = read_run(row);
  stored.under_way = !stored.end && written;
  return stored;
}

Result<std::vector<StoredRun>> RunLogReader::runs() {
  auto select = database_->prepare(select_runs() + " ORDER BY run");
  if (!select) return select.error();
  return collect<StoredRun>(*select, [&] { return read(*select); });
}

Result<StoredRun> RunLogReader::run(std::int64_t run) {
  auto select = database_->prepare(select_runs() + " WHERE run = ?");
  if (!select) return select.error();
  select->bind(run);
  const auto row = select->step();
  if (!row) return row.error();
  if (*row) return read(*select);
  const auto last = database_->integer("SELECT coalesce(max(run), 0) FROM runs");
  if (!last) return last.error();
  return Error{ErrorCode::kBadInput,
               *last == 0
                   ? fmt::format("{}: no run {}: it holds no runs yet", path_.string(), run)
                   : fmt::format("{}: no run {}: its last run is {}", path_.string(), run, *last)};
}

Result<std::vector<std::string>> RunLogReader::number_columns(const std::string& table) {
  auto select = database_->prepare("SELECT name FROM pragma_table_info(?) WHERE type = 'REAL'");
  if (!select) return select.error();
  select->bind(table);
  return collect<std::string>(*select, [&] { return select->text(0); });
}

Result<std::vector<StoredPoint>> RunLogReader::points(std::int64_t run) {
  std::string sql = "SELECT kind, test, block, segment, frames, frames_dropped, void_because";
  auto columns = number_columns("points");
  if (!columns) return columns.error();
  for (const auto& channel : procedures::point_channels()) {
    // A store of an older version lacks the columns that came later.
    const auto there = std::find(columns->begin(), columns->end(), channel.name);
    sql += there != columns->end() ? fmt::format(", {}", channel.name) : ", NULL";
    if (there != columns->end()) columns->erase(there);
  }
  // What is left are the auxiliary sensors'.
  for (const std::string& name : *columns) sql += fmt::format(", \"{}\"", name);
  auto select = database_->prepare(sql + " FROM points WHERE run = ? ORDER BY point");
  if (!select) return select.error();
  select->bind(run);
  return collect<StoredPoint>(*select, [&] {
    StoredPoint stored;
    Point& point = stored.point;
    point.kind = parse(select->text(0), kPointKinds);
    point.test = static_cast<int>(select->integer(1));
    point.block = static_cast<int>(select->integer(2));
    point.segment = select->text(3);
    point.count = static_cast<std::uint64_t>(select->integer(4));
    point.dropped = static_cast<std::uint64_t>(select->integer(5));
    stored.void_because = select->text(6);
    int index = 7;
    for (const auto& channel : procedures::point_channels()) {
      point.*channel.value = select->real(index++);
    }
    for (const std::string& name : *columns) {
      if (!select->is_null(index)) point.auxiliary[name] = select->real(index);
      ++index;
    }
    return stored;
  });
}

Result<std::vector<StoredRun>> RunLogReader::chain(std::int64_t run) {
  std::vector<StoredRun> parts;
  while (true) {
    auto part = this->run(run);
    if (!part) return part.error();
    parts.push_back(std::move(*part));
    const auto& before = parts.back().header.continues;
    // A run takes up an earlier one; a damaged store must not make this go round.
    if (!before || before->run >= run) break;
    run = before->run;
  }
  std::reverse(parts.begin(), parts.end());
  return parts;
}

Result<double> RunLogReader::zero_unix_s(const StoredRun& run) {
  const auto steps = this->steps(run.run);
  if (!steps) return steps.error();
  const double begin_s = steps->empty() ? 0.0 : steps->front().started_s;
  return drivers::seconds_of_utc(run.header.started_at) - begin_s;
}

Result<std::vector<StoredPoint>> RunLogReader::chain_points(std::int64_t run) {
  const auto parts = chain(run);
  if (!parts) return parts.error();
  std::vector<StoredPoint> all;
  std::optional<double> first_zero_s;  // by the calendar: when the first run's time was 0
  double set_s = 0.0;                  // how far the calendar was set forward since
  for (const StoredRun& part : *parts) {
    auto points = this->points(part.run);
    if (!points) return points.error();
    if (parts->size() > 1) {
      const auto zero = zero_unix_s(part);
      if (!zero) return zero.error();
      const double begin_s = drivers::seconds_of_utc(part.header.started_at) - *zero;
      const double zero_s = *zero - set_s;
      const auto stepped_s = clock_steps_s(part.run);
      if (!stepped_s) return stepped_s.error();
      set_s += *stepped_s;
      if (!first_zero_s) first_zero_s = zero_s;
      double shift_s = zero_s - *first_zero_s;
      if (!all.empty()) {
        const Point& last = all.back().point;
        const double end_s = last.time_s + last.duration_s / 2.0;
        if (!(begin_s + shift_s >= end_s)) shift_s = end_s - begin_s;
      }
      for (StoredPoint& point : *points) point.point.time_s += shift_s;
    }
    all.insert(all.end(), points->begin(), points->end());
  }
  return all;
}

Result<std::vector<InstrumentRecord>> RunLogReader::instruments(std::int64_t run) {
  auto select = database_->prepare(
      "SELECT role, identity, serial_number, calibrated_on, calibration_due FROM instruments "
      "WHERE run = ? ORDER BY role");
  if (!select) return select.error();
  select->bind(run);
  return collect<InstrumentRecord>(*select, [&] {
    return InstrumentRecord{select->text(0), select->text(1), select->text(2), select->text(3),
                            select->text(4)};
  });
}

Result<std::vector<StoredEvent>> RunLogReader::events(std::int64_t run) {
  auto select = database_->prepare(
      "SELECT time_s, severity, message, data_json FROM events WHERE run = ? ORDER BY event");
  if (!select) return select.error();
  select->bind(run);
  return collect<StoredEvent>(*select, [&] {
    return StoredEvent{select->real(0), select->text(1), select->text(2), select->text(3)};
  });
}

Result<std::vector<StoredBenchEvent>> RunLogReader::bench_events() {
  const auto known =
      database_->integer("SELECT count(*) FROM sqlite_master WHERE name = 'bench_events'");
  if (!known) return known.error();
  if (*known == 0) return std::vector<StoredBenchEvent>{};
  auto select = database_->prepare(
      "SELECT unix_s, severity, message, gyro_serial_number, data_json, bench FROM bench_events "
      "ORDER BY event");
  if (!select) return select.error();
  return collect<StoredBenchEvent>(*select, [&] {
    return StoredBenchEvent{
        {select->real(0), select->text(1), select->text(2), select->text(3), select->text(4)},
        select->text(5)};
  });
}

Result<std::vector<StoredStep>> RunLogReader::steps(std::int64_t run) {
  auto select = database_->prepare(
      "SELECT path, says, started_s, ended_s, evidence FROM steps WHERE run = ? ORDER BY step");
  if (!select) return select.error();
  select->bind(run);
  return collect<StoredStep>(*select, [&] {
    return StoredStep{select->text(0), select->text(1), select->real(2), select->real(3),
                      select->text(4)};
  });
}

Result<double> RunLogReader::last_time(std::int64_t run) {
  auto select = database_->prepare(
      "SELECT coalesce(max(t), 0) FROM ("
      "SELECT max(time_s) AS t FROM monitor WHERE run = ?1 UNION ALL "
      "SELECT max(time_s) FROM events WHERE run = ?1 UNION ALL "
      "SELECT max(coalesce(ended_s, started_s)) FROM steps WHERE run = ?1)");
  if (!select) return select.error();
  select->bind(run);
  const auto row = select->step();
  if (!row) return row.error();
  return *row ? select->real(0) : 0.0;
}

Result<double> RunLogReader::clock_steps_s(std::int64_t run) {
  auto select = database_->prepare(
      "SELECT coalesce(sum(json_extract(data_json, '$.clock_step_s')), 0.0) FROM events "
      "WHERE run = ? AND data_json LIKE '{\"clock_step_s\"%'");
  if (!select) return select.error();
  select->bind(run);
  const auto row = select->step();
  if (!row) return row.error();
  return *row ? select->real(0) : 0.0;
}

bool RunLogReader::being_written(std::int64_t run) const {
  return WritingLock::held(path_, run);
}

Status RunLogReader::read_gyro(std::int64_t run,
                               const std::function<Status(const drivers::GyroBlock& block)>& use) {
  auto select = database_->prepare(
      "SELECT chunk, first_index, frames, sha256, index_runs, rate_deg_per_h, temperature_c "
      "FROM gyro_chunks WHERE run = ? ORDER BY chunk");
  if (!select) return select.error();
  select->bind(run);
  drivers::GyroBlock block;
  std::int64_t expected = 0;
  while (true) {
    const auto row = select->step();
    if (!row) return row.error();
    if (!*row) return {};
    const auto failed = [&](const std::string& what) {
      return Error{ErrorCode::kStore, fmt::format("{}: run {}, chunk {}: {}", path_.string(), run,
                                                  select->integer(0), what)};
    };
    if (select->integer(0) != expected) return failed("a chunk before it is missing");
    ++expected;
    const auto copy = [&](int column) {
      const auto blob = select->blob(column);
      return std::vector<std::byte>(blob.begin(), blob.end());
    };
    Chunk chunk{select->integer(1), select->integer(2), copy(4), copy(5), copy(6), {}};
    const std::vector<std::byte> digest = copy(3);
    if (digest.size() != chunk.sha256.size()) return failed("damaged chunk: no SHA-256");
    std::copy(digest.begin(), digest.end(), chunk.sha256.begin());
    block.clear();
    if (const Status decoded = decode_chunk(chunk, block); !decoded) {
      return failed(decoded.error().message);
    }
    if (const Status used = use(block); !used) return used;
  }
}

Result<std::string> RunLogReader::raw_sha256(std::int64_t run) {
  auto select = database_->prepare("SELECT sha256 FROM gyro_chunks WHERE run = ? ORDER BY chunk");
  if (!select) return select.error();
  select->bind(run);
  std::vector<std::byte> hashes;
  while (true) {
    const auto row = select->step();
    if (!row) return row.error();
    if (!*row) return hexadecimal(sha256_of(hashes));
    const auto hash = select->blob(0);
    hashes.insert(hashes.end(), hash.begin(), hash.end());
  }
}

}  // namespace fogbench::record
