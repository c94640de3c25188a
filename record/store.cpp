#include "record/store.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <system_error>

#include "config/channels.hpp"
#include "config/units.hpp"
#include "procedures/channel_values.hpp"

namespace fogbench::record {
namespace fs = std::filesystem;

namespace {

// Everything but the columns that procedures/channel_values.hpp lists.
constexpr auto kTables = R"(
CREATE TABLE runs (
  run INTEGER PRIMARY KEY AUTOINCREMENT,
  procedure TEXT NOT NULL, procedure_json TEXT NOT NULL,
  bench TEXT NOT NULL, bench_json TEXT NOT NULL,
  scenario_json TEXT, seed TEXT,
  gyro_serial_number TEXT, operator_name TEXT, software_version TEXT,
  started_at TEXT NOT NULL,
  frame_rate_hz REAL, reference_rate_deg_per_h REAL,
  outcome TEXT, reason TEXT, safe_state_reached INTEGER, ended_at TEXT,
  frames_good INTEGER, frames_bad_checksum INTEGER, frames_invalid INTEGER,
  frames_repeated INTEGER, frames_missing INTEGER, bytes_skipped INTEGER,
  raw_sha256 TEXT,
  continues INTEGER REFERENCES runs, continues_at TEXT);
CREATE TABLE instruments (
  run INTEGER NOT NULL REFERENCES runs, role TEXT NOT NULL, identity TEXT,
  serial_number TEXT, calibrated_on TEXT, calibration_due TEXT,
  PRIMARY KEY (run, role)) WITHOUT ROWID;
CREATE TABLE steps (
  step INTEGER PRIMARY KEY, run INTEGER NOT NULL REFERENCES runs, path TEXT NOT NULL,
  says TEXT NOT NULL, started_s REAL, ended_s REAL, evidence TEXT);
CREATE INDEX steps_of_run ON steps (run);
CREATE TABLE events (
  event INTEGER PRIMARY KEY, run INTEGER NOT NULL REFERENCES runs, time_s REAL,
  severity TEXT NOT NULL, message TEXT NOT NULL, data_json TEXT);
CREATE INDEX events_of_run ON events (run);
CREATE TABLE gyro_chunks (
  run INTEGER NOT NULL REFERENCES runs, chunk INTEGER NOT NULL,
  first_index INTEGER NOT NULL, frames INTEGER NOT NULL, sha256 BLOB NOT NULL,
  index_runs BLOB, rate_deg_per_h BLOB NOT NULL, temperature_c BLOB,
  PRIMARY KEY (run, chunk));
CREATE TABLE channels (
  "table" TEXT NOT NULL, name TEXT NOT NULL, unit TEXT, meaning TEXT,
  PRIMARY KEY ("table", name)) WITHOUT ROWID;
)";

template <class Columns>
std::string real_columns(const Columns& columns) {
  std::string sql;
  for (const auto& column : columns) sql += fmt::format(", {} REAL", column.name);
  return sql;
}

template <class Columns>
Status describe(Database& database, std::string_view table, const Columns& columns) {
  auto insert = database.prepare("INSERT INTO channels VALUES (?, ?, ?, ?)");
  if (!insert) return insert.error();
  for (const auto& column : columns) {
    insert->bind(table).bind(column.name).bind(config::unit_of(column.name)).bind(column.meaning);
    if (const Status ok = insert->run(); !ok) return ok;
  }
  return {};
}

/// Nobody's tables, and nobody's mark: an empty file, or one whose maker was stopped at once.
Result<bool> is_blank(Database& database) {
  const auto application = database.integer("PRAGMA application_id");
  if (!application) return application.error();
  const auto tables = database.integer("SELECT count(*) FROM sqlite_master");
  if (!tables) return tables.error();
  return *application == 0 && *tables == 0;
}

/// What happens on a bench outside its runs came later than the second version, and takes nothing
/// from whoever does not know it.
Status add_bench_events(Database& database) {
  return database.execute(
      "CREATE TABLE IF NOT EXISTS bench_events (event INTEGER PRIMARY KEY, bench TEXT NOT NULL, "
      "unix_s REAL NOT NULL, severity TEXT NOT NULL, message TEXT NOT NULL, "
      "gyro_serial_number TEXT, data_json TEXT)");
}

/// Changes nothing where another program has made it meanwhile.
Status create_schema(Database& database) {
  // Pages of 16 KiB suit blobs of some 200 KiB. WAL is kept in the file from here on.
  if (const Status ok = database.execute("PRAGMA page_size = 16384; PRAGMA journal_mode = WAL");
      !ok) {
    return ok;
  }
  auto transaction = Transaction::begin(database);
  if (!transaction) return transaction.error();
  if (const auto blank = is_blank(database); !blank || !*blank) {
    return blank ? Status{} : blank.error();
  }
  const std::string sql = fmt::format(
      "{}"
      "CREATE TABLE points (point INTEGER PRIMARY KEY, run INTEGER NOT NULL REFERENCES runs, "
      "kind TEXT NOT NULL, test INTEGER NOT NULL, block INTEGER NOT NULL, segment TEXT NOT NULL, "
      "frames INTEGER NOT NULL, frames_dropped INTEGER NOT NULL, void_because TEXT{});"
      "CREATE INDEX points_of_run ON points (run);"
      "CREATE TABLE monitor (run INTEGER NOT NULL REFERENCES runs{}, mode TEXT);"
      "CREATE INDEX monitor_of_run ON monitor (run);"
      "PRAGMA application_id = {}; PRAGMA user_version = {}",
      kTables, real_columns(procedures::point_channels()),
      real_columns(procedures::monitor_channels()), kApplicationId, kSchemaVersion);
  if (const Status ok = database.execute(sql); !ok) return ok;
  if (const Status ok = add_bench_events(database); !ok) return ok;
  if (const Status ok = describe(database, "points", procedures::point_channels()); !ok) return ok;
  if (const Status ok = describe(database, "monitor", procedures::monitor_channels()); !ok)
    return ok;
  return transaction->commit();
}

/// A store of an older version gets the columns that came later; its rows have no values there.
Status add_new_columns(Database& database) {
  const auto add_all = [&](const char* table, const auto& channels) -> Status {
    for (const auto& channel : channels) {
      if (const Status ok = add_column(database, table, channel.name, channel.meaning); !ok) {
        return ok;
      }
    }
    return {};
  };
  if (const Status ok = add_all("points", procedures::point_channels()); !ok) return ok;
  return add_all("monitor", procedures::monitor_channels());
}

/// What the second version of the schema has and the first had not: runs that take up others.
Status add_continuations(Database& database) {
  const auto version = database.integer("PRAGMA user_version");
  if (!version) return version.error();
  if (*version >= kSchemaVersion) return {};
  auto transaction = Transaction::begin(database);
  if (!transaction) return transaction.error();
  const Status added =
      database.execute(fmt::format("ALTER TABLE runs ADD COLUMN continues INTEGER REFERENCES runs;"
                                   "ALTER TABLE runs ADD COLUMN continues_at TEXT;"
                                   "PRAGMA user_version = {}",
                                   kSchemaVersion));
  if (!added) return added;
  return transaction->commit();
}

Status check_schema(Database& database, const fs::path& path) {
  const auto blank = is_blank(database);
  if (!blank) return blank.error();
  if (*blank) {
    return Error{ErrorCode::kBadInput, fmt::format("{}: empty, no run log yet", path.string())};
  }
  const auto application = database.integer("PRAGMA application_id");
  if (!application) return application.error();
  if (*application != kApplicationId) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("{}: not a run log: a database of another program", path.string())};
  }
  const auto version = database.integer("PRAGMA user_version");
  if (!version) return version.error();
  if (*version > kSchemaVersion) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("{}: written by a newer fogbench (schema {}; this one reads {})",
                             path.string(), *version, kSchemaVersion)};
  }
  return {};
}

/// Where a link points, though nothing may be there yet.
fs::path without_links(fs::path path) {
  constexpr int kMostLinks = 40;  // as the kernel
  std::error_code error;
  for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(path, error)); ++i) {
    path = path.parent_path() / fs::read_symlink(path, error);
  }
  return path;
}

/// Makes the schema in a file of its own, then puts it in place: whoever is killed meanwhile, and
/// whoever else does the same, the store is whole.
Status create_store(const fs::path& path) {
  const fs::path fresh = fmt::format("{}.{}.new", path.string(), getpid());
  const auto made = [&]() -> Status {
    auto database = Database::open(fresh, Database::Mode::kCreate);
    if (!database) return database.error();
    return create_schema(**database);
  }();
  std::error_code error, ignored;
  if (made) {
    fs::create_hard_link(fresh, path, error);
    if (error == std::errc::file_exists) error.clear();  // another program was quicker
  }
  for (const char* suffix : {"", "-wal", "-shm"}) fs::remove(fresh.string() + suffix, ignored);
  if (!made) return made;
  if (error) {
    return Error{ErrorCode::kStore,
                 fmt::format("{}: cannot be created: {}", path.string(), error.message())};
  }
  return {};
}

}  // namespace

Status add_column(Database& database, std::string_view table, std::string_view name,
                  std::string_view meaning) {
  const auto there = database.integer(
      fmt::format("SELECT count(*) FROM pragma_table_info('{}') WHERE name = '{}'", table, name));
  if (!there) return there.error();
  if (*there != 0) return {};
  auto transaction = Transaction::begin(database);
  if (!transaction) return transaction.error();
  const Status added =
      database.execute(fmt::format("ALTER TABLE {} ADD COLUMN \"{}\" REAL", table, name));
  if (!added) return added;
  const config::Channel channel{name, meaning};
  if (const Status ok = describe(database, table, std::span(&channel, 1)); !ok) return ok;
  return transaction->commit();
}

Result<fs::path> default_store() {
  const auto variable = [](const char* name) -> fs::path {
    const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe)
    return value == nullptr ? "" : value;
  };
  if (const fs::path store = variable("FOGBENCH_STORE"); !store.empty()) return store;
  if (const fs::path state = variable("XDG_STATE_HOME"); state.is_absolute()) {
    return state / "fogbench" / "fogbench.db";
  }
  if (const fs::path home = variable("HOME"); !home.empty()) {
    return home / ".local" / "state" / "fogbench" / "fogbench.db";
  }
  return Error{ErrorCode::kBadInput,
               "no place for the run log: name a file with --store, or set FOGBENCH_STORE"};
}

fs::path beside_store(const fs::path& store, std::string_view suffix) {
  std::error_code error;
  fs::path file = fs::weakly_canonical(store, error);
  if (error) file = store;
  return file += suffix;
}

void make_default_folder(const fs::path& store) {
  const auto standard = default_store();
  std::error_code ignored;  // whoever opens a file there says what is wrong
  if (standard && store == *standard) fs::create_directories(store.parent_path(), ignored);
}

Result<std::unique_ptr<Database>> open_store(const fs::path& path) {
  auto database = Database::open(path, Database::Mode::kRead);
  if (!database) return database;
  if (const Status ok = check_schema(**database, path); !ok) return ok.error();
  return database;
}

Result<std::unique_ptr<Database>> open_store_for_writing(const fs::path& path) {
  make_default_folder(path);
  std::error_code error;
  if (!fs::exists(path, error)) {
    if (const Status made = create_store(without_links(path)); !made) return made.error();
  }
  auto database = Database::open(path, Database::Mode::kWrite);
  if (!database) return database;
  if (const auto blank = is_blank(**database); !blank) {
    return blank.error();
  } else if (*blank) {
    if (const Status made = create_schema(**database); !made) return made.error();
  }
  if (const Status ok = check_schema(**database, path); !ok) return ok.error();
  if (const Status ok = add_new_columns(**database); !ok) return ok.error();
  if (const Status ok = add_continuations(**database); !ok) return ok.error();
  if (const Status ok = add_bench_events(**database); !ok) return ok.error();
  if (const Status ok = (*database)->execute("PRAGMA synchronous = FULL"); !ok) return ok.error();
  return database;
}

}  // namespace fogbench::record
