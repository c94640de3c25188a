#include "record/store.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <system_error>

#include "config/units.hpp"

namespace fogbench::record {
namespace fs = std::filesystem;
using procedures::MonitorRow;
using procedures::Point;

namespace {

constexpr PointColumn kPointColumns[] = {
    {"time_s", "centre of the averaging window since power-on", &Point::time_s},
    {"duration_s", "length of the averaging window", &Point::duration_s},
    {"rate_deg_per_h", "mean rate, reference rate subtracted", &Point::rate_deg_per_h},
    {"rate_std_deg_per_h", "scatter of the samples in the window", &Point::rate_std_deg_per_h},
    {"rate_std_error_deg_per_h", "scatter over sqrt(frames): white noise only, a lower bound",
     &Point::rate_std_error_deg_per_h},
    {"temperature_c", "mean of the two working sensors", &Point::temperature_c},
    {"temperature_start_c", "temperature at the window's start, freed of the sensors' lag",
     &Point::temperature_start_c},
    {"temperature_end_c", "temperature at the window's end, freed of the sensors' lag",
     &Point::temperature_end_c},
    {"temperature_rate_c_per_h", "mean over the window, freed of the sensors' lag",
     &Point::temperature_rate_c_per_h},
    {"temperature_gradient_c", "working sensor 1 minus working sensor 2",
     &Point::temperature_gradient_c},
    {"temperature_control_c", "control sensor", &Point::temperature_control_c},
    {"target_c", "thermostat's target", &Point::target_c},
    {"ambient_c", "air around the gyro", &Point::ambient_c},
    {"heater_w", "heating power, all heaters", &Point::heater_w},
    {"field_x_ut", "measured field along the gyro's x axis", &Point::field_x_ut},
    {"field_y_ut", "measured field along the gyro's y axis", &Point::field_y_ut},
    {"field_z_ut", "measured field along the gyro's z axis", &Point::field_z_ut},
    {"field_set_ut", "commanded level of a sweep; NULL outside one", &Point::field_set_ut},
    {"coil_current_a", "measured current of the energised pair", &Point::coil_current_a},
    {"current_horizontal_a", "measured current of the horizontal pair",
     &Point::current_horizontal_a},
    {"current_vertical_a", "measured current of the vertical pair", &Point::current_vertical_a},
    {"azimuth_deg", "azimuth of the gyro", &Point::azimuth_deg},
};

constexpr MonitorColumn kMonitorColumns[] = {
    {"time_s", "since power-on", [](const MonitorRow& row) { return row.time_s; }},
    {"temperature_working_1_c", "working sensor 1",
     [](const MonitorRow& row) { return row.thermostat.working_1.value; }},
    {"temperature_working_2_c", "working sensor 2",
     [](const MonitorRow& row) { return row.thermostat.working_2.value; }},
    {"temperature_control_c", "control sensor",
     [](const MonitorRow& row) { return row.thermostat.control.value; }},
    {"ambient_c", "air around the gyro",
     [](const MonitorRow& row) { return row.thermostat.ambient.value; }},
    {"target_c", "thermostat's target",
     [](const MonitorRow& row) { return row.thermostat.target.value; }},
    {"boost_w", "boost heaters' power",
     [](const MonitorRow& row) { return row.thermostat.boost_power.value; }},
    {"normal_w", "normal heater's power",
     [](const MonitorRow& row) { return row.thermostat.normal_power.value; }},
    {"field_x_ut", "measured field along the gyro's x axis",
     [](const MonitorRow& row) { return row.field.field[0].value; }},
    {"field_y_ut", "measured field along the gyro's y axis",
     [](const MonitorRow& row) { return row.field.field[1].value; }},
    {"field_z_ut", "measured field along the gyro's z axis",
     [](const MonitorRow& row) { return row.field.field[2].value; }},
    {"current_horizontal_a", "measured current of the horizontal pair",
     [](const MonitorRow& row) { return row.current_horizontal_a; }},
    {"current_vertical_a", "measured current of the vertical pair",
     [](const MonitorRow& row) { return row.current_vertical_a; }},
    {"azimuth_deg", "azimuth of the gyro", [](const MonitorRow& row) { return row.azimuth_deg; }},
};

// Everything but the columns that point_columns() and monitor_columns() list.
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
      kTables, real_columns(point_columns()), real_columns(monitor_columns()), kApplicationId,
      kSchemaVersion);
  if (const Status ok = database.execute(sql); !ok) return ok;
  if (const Status ok = describe(database, "points", point_columns()); !ok) return ok;
  if (const Status ok = describe(database, "monitor", monitor_columns()); !ok) return ok;
  return transaction->commit();
}

/// A store of an older version gets the columns of points that came later; its rows have no values
/// there.
Status add_new_columns(Database& database) {
  for (const PointColumn& column : point_columns()) {
    const auto there = database.integer(fmt::format(
        "SELECT count(*) FROM pragma_table_info('points') WHERE name = '{}'", column.name));
    if (!there) return there.error();
    if (*there != 0) continue;
    auto transaction = Transaction::begin(database);
    if (!transaction) return transaction.error();
    const Status added =
        database.execute(fmt::format("ALTER TABLE points ADD COLUMN {} REAL", column.name));
    if (!added) return added;
    if (const Status ok = describe(database, "points", std::span(&column, 1)); !ok) return ok;
    if (const Status ok = transaction->commit(); !ok) return ok;
  }
  return {};
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

std::span<const PointColumn> point_columns() {
  return kPointColumns;
}

std::span<const MonitorColumn> monitor_columns() {
  return kMonitorColumns;
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
  if (const Status ok = (*database)->execute("PRAGMA synchronous = FULL"); !ok) return ok.error();
  return database;
}

}  // namespace fogbench::record
