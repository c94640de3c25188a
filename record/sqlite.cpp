#include "record/sqlite.hpp"

#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <limits>
#include <system_error>
#include <utility>

namespace fogbench::record {
namespace fs = std::filesystem;

namespace {

// How long another process may hold the store before this one gives up, ms: a commit of a chunk
// takes milliseconds, a checkpoint at most a second or so.
constexpr int kLockWaitMs = 5000;

Error store_error(sqlite3* handle, const std::string& path) {
  const int code = handle == nullptr ? SQLITE_NOMEM : sqlite3_errcode(handle);
  const std::string detail = handle == nullptr ? "out of memory" : sqlite3_errmsg(handle);
  switch (code & 0xff) {
    case SQLITE_NOTADB:
      return Error{ErrorCode::kBadInput,
                   fmt::format("{}: not a run log: the file is not an SQLite database", path)};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return Error{ErrorCode::kStore,
                   fmt::format("{}: locked by another program for more than {} s", path,
                               kLockWaitMs / 1000)};
    case SQLITE_FULL:
      return Error{ErrorCode::kStore, fmt::format("{}: the disk is full", path)};
    case SQLITE_READONLY:
      return Error{ErrorCode::kStore, fmt::format("{}: read-only; cannot be written", path)};
    case SQLITE_CORRUPT:
      return Error{ErrorCode::kStore, fmt::format("{}: damaged: {}", path, detail)};
    default: {
      const int system = handle == nullptr ? 0 : sqlite3_system_errno(handle);
      const std::string reason =
          system == 0 ? "" : " (" + std::generic_category().message(system) + ")";
      return Error{ErrorCode::kStore, fmt::format("{}: {}{}", path, detail, reason)};
    }
  }
}

/// What to hand to sqlite3_open_v2.
struct Source {
  std::string name;
  int flags;
};

Source source_of(const fs::path& path, Database::Mode mode) {
  constexpr int kWrite = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_READWRITE;
  if (mode == Database::Mode::kCreate) return {path.string(), kWrite | SQLITE_OPEN_CREATE};
  if (mode == Database::Mode::kWrite) return {path.string(), kWrite};
  // A reader of a WAL database shares memory with its writer through a file beside it, and tidies
  // it away when it is the last: it needs to write there.
  const fs::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (access(path.c_str(), W_OK) == 0 && access(folder.c_str(), W_OK) == 0) {
    return {path.string(), kWrite};
  }
  constexpr int kRead = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_READONLY;
  std::error_code error;
  if (fs::exists(path.string() + "-wal", error)) return {path.string(), kRead};
  // Read-only medium, and nobody is writing: it is read as a file that does not change.
  std::string uri = "file:";
  for (const char c : path.string()) {
    uri += c == '%' || c == '?' || c == '#' ? fmt::format("%{:02x}", c) : std::string(1, c);
  }
  return {uri + "?immutable=1", kRead | SQLITE_OPEN_URI};
}

}  // namespace

void Statement::Finalise::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

Statement::Statement(sqlite3_stmt* statement, std::string path)
    : statement_(statement), path_(std::move(path)) {}

Statement& Statement::bind(std::int64_t value) {
  return bound(sqlite3_bind_int64(statement_.get(), next_, value));
}

Statement& Statement::bind(double value) {
  return bound(sqlite3_bind_double(statement_.get(), next_, value));
}

Statement& Statement::bind(std::string_view text) {
  return bound(sqlite3_bind_text64(statement_.get(), next_, text.data(), text.size(),
                                   SQLITE_TRANSIENT, SQLITE_UTF8));
}

Statement& Statement::bind(std::span<const std::byte> blob) {
  if (blob.empty()) return bound(sqlite3_bind_zeroblob(statement_.get(), next_, 0));
  return bound(
      sqlite3_bind_blob64(statement_.get(), next_, blob.data(), blob.size(), SQLITE_STATIC));
}

Statement& Statement::bind_null() {
  return bound(sqlite3_bind_null(statement_.get(), next_));
}

Statement& Statement::bound(int code) {
  if (code != SQLITE_OK && bind_code_ == SQLITE_OK) bind_code_ = code;
  ++next_;
  return *this;
}

Result<bool> Statement::step() {
  if (bind_code_ != SQLITE_OK) {
    const char* reason = sqlite3_errstr(bind_code_);
    reset();
    return Error{ErrorCode::kStore, fmt::format("{}: a value cannot be stored: {}", path_, reason)};
  }
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  const Error error = store_error(sqlite3_db_handle(statement_.get()), path_);
  reset();
  return error;
}

Status Statement::run() {
  const auto stepped = step();
  if (!stepped) return stepped.error();
  reset();
  return {};
}

void Statement::reset() {
  sqlite3_reset(statement_.get());
  sqlite3_clear_bindings(statement_.get());
  next_ = 1;
  bind_code_ = SQLITE_OK;
}

bool Statement::is_null(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

double Statement::real(int column) const {
  return is_null(column) ? std::numeric_limits<double>::quiet_NaN()
                         : sqlite3_column_double(statement_.get(), column);
}

std::string Statement::text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_.get(), column);
  if (text == nullptr) return {};
  return {reinterpret_cast<const char*>(text),
          static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

std::span<const std::byte> Statement::blob(int column) const {
  const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(statement_.get(), column));
  return {data, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}

Database::Database(sqlite3* handle, std::string path) : handle_(handle), path_(std::move(path)) {}

Database::~Database() {
  sqlite3_close_v2(handle_);  // statements that are still alive keep it until they go
}

Result<std::unique_ptr<Database>> Database::open(const fs::path& path, Mode mode) {
  std::error_code error;
  if (mode != Mode::kCreate) {
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::none) {  // nobody may know: no permission, above all
      return Error{ErrorCode::kBadInput, fmt::format("{}: {}", path.string(), error.message())};
    }
    if (!fs::exists(status)) {
      return Error{ErrorCode::kBadInput, fmt::format("{}: no such run log", path.string())};
    }
    if (!fs::is_regular_file(status)) {
      return Error{ErrorCode::kBadInput,
                   fmt::format("{}: not a run log: not a regular file", path.string())};
    }
  }
  sqlite3* handle = nullptr;
  const Source source = source_of(path, mode);
  const int code = sqlite3_open_v2(source.name.c_str(), &handle, source.flags, nullptr);
  std::unique_ptr<Database> database(new Database(handle, path.string()));
  if (code != SQLITE_OK) return store_error(handle, path.string());
  sqlite3_busy_timeout(handle, kLockWaitMs);
  if (mode == Mode::kRead) {
    if (const Status ok = database->execute("PRAGMA query_only = ON"); !ok) return ok.error();
  }
  return database;
}

Status Database::execute(const std::string& sql) {
  if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    return store_error(handle_, path_);
  }
  return {};
}

Result<Statement> Database::prepare(const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(handle_, sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) {
    return store_error(handle_, path_);
  }
  return Statement(statement, path_);
}

Result<std::int64_t> Database::integer(const std::string& sql) {
  auto statement = prepare(sql);
  if (!statement) return statement.error();
  const auto row = statement->step();
  if (!row) return row.error();
  if (!*row) return Error{ErrorCode::kStore, fmt::format("{}: no rows from: {}", path_, sql)};
  return statement->integer(0);
}

std::int64_t Database::last_insert_id() const {
  return sqlite3_last_insert_rowid(handle_);
}

Status Database::check_in_place() {
  int moved = 0;
  if (sqlite3_file_control(handle_, "main", SQLITE_FCNTL_HAS_MOVED, &moved) != SQLITE_OK ||
      moved == 0) {
    return {};
  }
  return Error{ErrorCode::kStore, path_ + ": the file was removed, moved or replaced"};
}

Result<Transaction> Transaction::begin(Database& database) {
  // IMMEDIATE: waits for another writer now, not in the middle.
  if (const Status begun = database.execute("BEGIN IMMEDIATE"); !begun) return begun.error();
  return Transaction(database);
}

Transaction::Transaction(Transaction&& other) noexcept
    : database_(std::exchange(other.database_, nullptr)) {}

Transaction::~Transaction() {
  if (database_ != nullptr) (void)database_->execute("ROLLBACK");
}

Status Transaction::commit() {
  const Status committed = database_->execute("COMMIT");
  if (committed) database_ = nullptr;
  return committed;
}

}  // namespace fogbench::record
