#pragma once
// SQLite with this project's errors: Result instead of codes, values freed by themselves.
// One connection and its statements belong to one thread.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "config/result.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace fogbench::record {

/// A prepared statement. Bind in order, step, read columns from 0, reset. It must not outlive its
/// Database.
class Statement {
 public:
  Statement(sqlite3_stmt* statement, std::string path);
  Statement(Statement&&) noexcept = default;
  Statement& operator=(Statement&&) noexcept = default;

  Statement& bind(std::int64_t value);
  /// NaN is stored as NULL.
  Statement& bind(double value);
  /// Copied.
  Statement& bind(std::string_view text);
  /// Not copied: must live until the statement has stepped.
  Statement& bind(std::span<const std::byte> blob);
  Statement& bind_null();

  /// True when there is a row to read. An error when a value could not be bound, too.
  Result<bool> step();
  /// For a statement without rows: steps and resets, so that it can be bound again.
  Status run();
  void reset();

  bool is_null(int column) const;
  std::int64_t integer(int column) const;
  /// NaN for NULL.
  double real(int column) const;
  std::string text(int column) const;
  /// Valid until the next step or reset.
  std::span<const std::byte> blob(int column) const;

 private:
  Statement& bound(int code);
  struct Finalise {
    void operator()(sqlite3_stmt* statement) const;
  };
  std::unique_ptr<sqlite3_stmt, Finalise> statement_;
  std::string path_;
  int next_ = 1;
  int bind_code_ = 0;  ///< of the first bind that failed since the last reset
};

class Database {
 public:
  enum class Mode { kRead, kWrite, kCreate };

  /// Errors: kBadInput when there is no such file or it is not a database, kStore when it cannot
  /// be used (locked, unreadable, disk).
  static Result<std::unique_ptr<Database>> open(const std::filesystem::path& path, Mode mode);
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;
  ~Database();

  Status execute(const std::string& sql);
  Result<Statement> prepare(const std::string& sql);
  /// The first column of the first row of `sql`; kStore when there is none.
  Result<std::int64_t> integer(const std::string& sql);
  std::int64_t last_insert_id() const;
  /// kStore when the file was removed, moved or replaced since it was opened: what is written then
  /// would be in a file that nobody finds.
  Status check_in_place();

 private:
  Database(sqlite3* handle, std::string path);
  sqlite3* handle_;
  std::string path_;
};

/// Rolls back unless committed.
class Transaction {
 public:
  static Result<Transaction> begin(Database& database);
  Transaction(Transaction&& other) noexcept;
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();
  Status commit();

 private:
  explicit Transaction(Database& database) : database_(&database) {}
  Database* database_;
};

}  // namespace fogbench::record
