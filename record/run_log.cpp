#include "record/run_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "procedures/channel_values.hpp"
#include "record/store.hpp"

namespace fogbench::record {
using procedures::InstrumentRecord;
using procedures::monitor_channels;
using procedures::MonitorRow;
using procedures::Point;
using procedures::point_channels;
using procedures::RunEnd;
using procedures::RunHeader;

namespace {

constexpr std::size_t kChunkFrames = 65536;
constexpr std::size_t kMonitorRows = 64;  // about a minute's

std::string placeholders(std::size_t count) {
  std::string list = "?";
  for (std::size_t i = 1; i < count; ++i) list += ", ?";
  return list;
}

template <class... Columns>
std::string names(const Columns&... columns) {
  std::string list;
  const auto add = [&](const auto& some) {
    for (const auto& column : some) list += fmt::format(", \"{}\"", column.name);
  };
  (add(columns), ...);
  return list;
}

}  // namespace

struct RunLog::Statements {
  Statement step_started, step_ended, event, point, void_block, monitor, chunk;
};

RunLog::RunLog(std::unique_ptr<Database> database, std::unique_ptr<WritingLock> writing)
    : database_(std::move(database)), writing_(std::move(writing)) {}
RunLog::~RunLog() = default;

Result<std::unique_ptr<RunLog>> RunLog::open(const std::filesystem::path& path) {
  auto database = open_store_for_writing(path);
  if (!database) return database.error();
  auto writing = WritingLock::open(path);
  if (!writing) return writing.error();
  std::unique_ptr<RunLog> log(new RunLog(std::move(*database), std::move(*writing)));
  if (const Status prepared = log->prepare(); !prepared) return prepared.error();
  return log;
}

Status RunLog::prepare() {
  const std::string sql[] = {
      "INSERT INTO steps (run, path, says, started_s) VALUES (?, ?, ?, ?)",
      "UPDATE steps SET ended_s = ?, evidence = ? WHERE step = ? AND path = ?",
      "INSERT INTO events (run, time_s, severity, message, data_json) VALUES (?, ?, ?, ?, ?)",
      fmt::format("INSERT INTO points (run, kind, test, block, segment, frames, frames_dropped{}) "
                  "VALUES ({})",
                  names(point_channels(), auxiliary_),
                  placeholders(7 + point_channels().size() + auxiliary_.size())),
      "UPDATE points SET void_because = ? WHERE run = ? AND block = ? AND void_because IS NULL",
      fmt::format("INSERT INTO monitor (run{}, mode) VALUES ({})",
                  names(monitor_channels(), auxiliary_),
                  placeholders(2 + monitor_channels().size() + auxiliary_.size())),
      "INSERT INTO gyro_chunks VALUES (?, ?, ?, ?, ?, ?, ?, ?)"};
  std::vector<Statement> prepared;
  for (const std::string& text : sql) {
    auto statement = database_->prepare(text);
    if (!statement) return statement.error();
    prepared.push_back(std::move(*statement));
  }
  statements_ = std::make_unique<Statements>(
      Statements{std::move(prepared[0]), std::move(prepared[1]), std::move(prepared[2]),
                 std::move(prepared[3]), std::move(prepared[4]), std::move(prepared[5]),
                 std::move(prepared[6])});
  return {};
}

Status RunLog::take_channels(const std::vector<RunHeader::Auxiliary>& channels) {
  for (const auto& channel : channels) {
    for (const std::string_view table : {"points", "monitor"}) {
      const Status added = add_column(*database_, table, channel.name, channel.meaning);
      if (!added) return added;
    }
  }
  auxiliary_ = channels;
  return prepare();
}

template <class Write>
Status RunLog::commit(Sync sync, Write write) {
  if (sync == Sync::kFull) {
    if (const Status there = database_->check_in_place(); !there) return there;
  }
  if (sync != sync_) {
    const Status ok = database_->execute(sync == Sync::kFull ? "PRAGMA synchronous = FULL"
                                                             : "PRAGMA synchronous = NORMAL");
    if (!ok) return ok;
    sync_ = sync;
  }
  auto transaction = Transaction::begin(*database_);
  if (!transaction) return transaction.error();
  if (const Status ok = write(); !ok) return ok;
  if (const Status ok = write_monitor(); !ok) return ok;
  if (const Status ok = transaction->commit(); !ok) return ok;
  monitor_.clear();
  return {};
}

Result<std::int64_t> RunLog::begin_run(const RunHeader& header,
                                       const std::vector<InstrumentRecord>& instruments) {
  chunk_ = 0;
  chunk_hashes_.clear();
  pending_.clear();
  monitor_.clear();
  if (const Status ready = take_channels(header.auxiliary); !ready) return ready.error();
  auto insert = database_->prepare(
      "INSERT INTO runs (procedure, procedure_json, bench, bench_json, scenario_json, seed, "
      "gyro_serial_number, operator_name, software_version, started_at, frame_rate_hz, "
      "reference_rate_deg_per_h, continues, continues_at) VALUES "
      "(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  auto instrument = database_->prepare("INSERT INTO instruments VALUES (?, ?, ?, ?, ?, ?)");
  if (!insert) return insert.error();
  if (!instrument) return instrument.error();
  const Status written = commit(Sync::kFull, [&]() -> Status {
    if (header.continues) {
      if (const Status free = check_free(header.continues->run); !free) return free;
    }
    insert->bind(header.procedure).bind(header.procedure_json);
    insert->bind(header.bench).bind(header.bench_json);
    header.scenario_json.empty() ? insert->bind_null() : insert->bind(header.scenario_json);
    // Text: SQLite's integers are signed, and a seed has 64 bits.
    header.seed ? insert->bind(std::to_string(*header.seed)) : insert->bind_null();
    insert->bind(header.gyro_serial_number).bind(header.operator_name);
    insert->bind(header.software_version).bind(header.started_at);
    insert->bind(header.frame_rate_hz);
    insert->bind(header.reference_rate_deg_per_h);
    if (header.continues) {
      insert->bind(header.continues->run).bind(header.continues->first_step);
    } else {
      insert->bind_null().bind_null();
    }
    if (const Status ok = insert->run(); !ok) return ok;
    run_ = database_->last_insert_id();
    // Before anybody can see it.
    if (const Status held = writing_->hold(run_); !held) return held;
    if (header.continues) {
      if (const Status ok = take_up(*header.continues); !ok) return ok;
    }
    for (const InstrumentRecord& record : instruments) {
      instrument->bind(run_).bind(record.role).bind(record.identity).bind(record.serial_number);
      instrument->bind(record.calibrated_on).bind(record.calibration_due);
      if (const Status ok = instrument->run(); !ok) return ok;
    }
    return {};
  });
  if (!written) {
    writing_->release();
    return written.error();
  }
  return run_;
}

/// What a run has measured must not be counted by two others.
Status RunLog::check_free(std::int64_t run) {
  const auto other = database_->integer(
      fmt::format("SELECT coalesce(max(run), 0) FROM runs WHERE continues = {}", run));
  if (!other) return other.error();
  if (*other == 0) return {};
  return Error{ErrorCode::kBadInput,
               fmt::format("run {} cannot be taken up: run {} did already", run, *other)};
}

/// Together with the begin of the run that takes it up: never one without the other.
Status RunLog::take_up(const procedures::Continuation& before) {
  const std::string why = fmt::format("measured anew in run {}, which takes this one up", run_);
  for (const auto& repeated : before.repeated) {
    auto voided = database_->prepare(
        "UPDATE points SET void_because = ? WHERE run = ? AND time_s >= ? AND void_because IS "
        "NULL");
    if (!voided) return voided.error();
    voided->bind(why).bind(repeated.run).bind(repeated.from_s);
    if (const Status ok = voided->run(); !ok) return ok;
  }
  auto close = database_->prepare(
      "UPDATE runs SET outcome = 'interrupted', reason = ? WHERE run = ? AND outcome IS NULL");
  if (!close) return close.error();
  close->bind(fmt::format("taken up by run {}", run_)).bind(before.run);
  if (const Status ok = close->run(); !ok) return ok;
  Statement& insert = statements_->event;
  insert.bind(run_).bind(0.0).bind("warning").bind(before.says).bind(before.data_json);
  return insert.run();
}

Status RunLog::give_up(std::int64_t run, const std::string& reason) {
  auto close = database_->prepare(
      "UPDATE runs SET outcome = 'interrupted', reason = ? WHERE run = ? AND outcome IS NULL");
  if (!close) return close.error();
  return commit(Sync::kFull, [&] { return close->bind(reason).bind(run).run(); });
}

Status RunLog::step_started(const std::string& path, const std::string& what, double time_s) {
  return commit(Sync::kNormal, [&] {
    const Status ok = statements_->step_started.bind(run_).bind(path).bind(what).bind(time_s).run();
    step_ = database_->last_insert_id();
    return ok;
  });
}

Status RunLog::step_ended(const std::string& path, double time_s, const std::string& evidence) {
  return commit(Sync::kNormal, [&] {
    return statements_->step_ended.bind(time_s).bind(evidence).bind(step_).bind(path).run();
  });
}

Status RunLog::event(double time_s, const std::string& severity, const std::string& message,
                     const std::string& data_json) {
  return commit(Sync::kFull, [&] {
    Statement& insert = statements_->event;
    insert.bind(run_).bind(time_s).bind(severity).bind(message);
    data_json.empty() ? insert.bind_null() : insert.bind(data_json);
    return insert.run();
  });
}

Status RunLog::bench_event(const std::string& bench, const BenchEvent& event) {
  auto insert = database_->prepare(
      "INSERT INTO bench_events (bench, unix_s, severity, message, gyro_serial_number, data_json) "
      "VALUES (?, ?, ?, ?, ?, ?)");
  if (!insert) return insert.error();
  return commit(Sync::kFull, [&] {
    insert->bind(bench).bind(event.unix_s).bind(event.severity).bind(event.message);
    for (const std::string* text : {&event.gyro_serial_number, &event.data_json}) {
      text->empty() ? insert->bind_null() : insert->bind(*text);
    }
    return insert->run();
  });
}

Status RunLog::point(const Point& point) {
  return commit(Sync::kFull, [&] {
    Statement& insert = statements_->point;
    insert.bind(run_).bind(name_of(point.kind)).bind(std::int64_t{point.test});
    insert.bind(std::int64_t{point.block}).bind(point.segment);
    insert.bind(static_cast<std::int64_t>(point.count));
    insert.bind(static_cast<std::int64_t>(point.dropped));
    for (const auto& channel : point_channels()) insert.bind(point.*channel.value);
    for (const auto& channel : auxiliary_)
      insert.bind(procedures::value_of(point.auxiliary, channel.name));
    return insert.run();
  });
}

Status RunLog::void_block(int block, double time_s, const std::string& reason) {
  return commit(Sync::kFull, [&]() -> Status {
    statements_->void_block.bind(reason).bind(run_).bind(std::int64_t{block});
    if (const Status ok = statements_->void_block.run(); !ok) return ok;
    Statement& insert = statements_->event;
    insert.bind(run_).bind(time_s).bind("warning");
    insert.bind(fmt::format("block {}: its points are void: {}", block, reason)).bind_null();
    return insert.run();
  });
}

Status RunLog::monitor(const MonitorRow& row) {
  monitor_.push_back(row);
  if (monitor_.size() < kMonitorRows) return {};
  return commit(Sync::kNormal, []() -> Status { return {}; });
}

Status RunLog::write_monitor() {
  Statement& insert = statements_->monitor;
  for (const MonitorRow& row : monitor_) {
    insert.bind(run_);
    for (const auto& channel : monitor_channels()) insert.bind(channel.value(row));
    for (const auto& channel : auxiliary_)
      insert.bind(procedures::value_of(row.auxiliary, channel.name));
    insert.bind(name_of(row.thermostat.mode));
    if (const Status ok = insert.run(); !ok) return ok;
  }
  return {};
}

Status RunLog::gyro_samples(const drivers::GyroBlock& block) {
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(pending_.index, block.index);
  append(pending_.rate_deg_per_h, block.rate_deg_per_h);
  append(pending_.temperature_c, block.temperature_c);
  while (pending_.index.size() >= kChunkFrames) {
    if (const Status ok = write_chunk(kChunkFrames); !ok) return ok;
  }
  return {};
}

Status RunLog::write_chunk(std::size_t frames) {
  const auto head = [frames](const auto& column) {
    return std::span(column).first(std::min(frames, column.size()));
  };
  const auto chunk = encoder_.encode(head(pending_.index), head(pending_.rate_deg_per_h),
                                     head(pending_.temperature_c));
  if (!chunk) return chunk.error();
  const Chunk& encoded = **chunk;
  const Status written = commit(Sync::kNormal, [&] {
    Statement& insert = statements_->chunk;
    insert.bind(run_).bind(chunk_).bind(encoded.first_index).bind(encoded.frames);
    insert.bind(std::span<const std::byte>(encoded.sha256));
    for (const auto* blob : {&encoded.index_runs, &encoded.rate, &encoded.temperature}) {
      blob->empty() ? insert.bind_null() : insert.bind(std::span<const std::byte>(*blob));
    }
    return insert.run();
  });
  if (!written) return written;
  ++chunk_;
  chunk_hashes_.insert(chunk_hashes_.end(), encoded.sha256.begin(), encoded.sha256.end());
  const auto drop = [frames](auto& column) {
    const auto count = static_cast<std::ptrdiff_t>(std::min(frames, column.size()));
    column.erase(column.begin(), column.begin() + count);
  };
  drop(pending_.index);
  drop(pending_.rate_deg_per_h);
  drop(pending_.temperature_c);
  return {};
}

Status RunLog::end_run(const RunEnd& end) {
  Status written = write_end(end);
  // Over, whether or not it is on record: nothing is measured any more.
  writing_->release();
  return written;
}

Status RunLog::write_end(const RunEnd& end) {
  if (!pending_.index.empty()) {
    if (const Status ok = write_chunk(pending_.index.size()); !ok) return ok;
  }
  auto update = database_->prepare(
      "UPDATE runs SET outcome = ?, reason = ?, safe_state_reached = ?, ended_at = ?, "
      "frames_good = ?, frames_bad_checksum = ?, frames_invalid = ?, frames_repeated = ?, "
      "frames_missing = ?, bytes_skipped = ?, raw_sha256 = ? WHERE run = ?");
  if (!update) return update.error();
  return commit(Sync::kFull, [&] {
    update->bind(name_of(end.outcome)).bind(end.reason);
    update->bind(std::int64_t{end.safe_state_reached}).bind(end.ended_at);
    const drivers::StreamStatistics& stream = end.stream;
    for (const std::uint64_t count :
         {stream.frames_good, stream.frames_bad_checksum, stream.frames_invalid,
          stream.frames_repeated, stream.frames_missing, stream.bytes_skipped}) {
      update->bind(static_cast<std::int64_t>(count));
    }
    update->bind(hexadecimal(sha256_of(chunk_hashes_))).bind(run_);
    return update->run();
  });
}

}  // namespace fogbench::record
