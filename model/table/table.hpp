#pragma once
// A measurement table: named columns of numbers (NaN is missing), with the run and the segment of
// each row.

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fogbench::model {

/// In tables and results: no value.
inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// Texts of one column, stored once each: a table has millions of rows and a few segments.
struct TextColumn {
  std::vector<std::string> values;
  std::vector<std::uint32_t> index;  ///< one per row, into values
  const std::string& at(std::size_t row) const { return values[index[row]]; }
};

class Table {
 public:
  std::size_t rows() const { return rows_; }
  bool has(std::string_view name) const;
  /// Precondition: has(name). One value per row.
  std::span<const double> column(std::string_view name) const;
  std::vector<std::string> column_names() const;
  /// One line that says why the table lacks the column: it was dropped because of its text (file,
  /// line, what was found), or it was never there (and which columns are).
  std::string why_missing(std::string_view name) const;

  /// "1" and "" for every row where the source has no such column.
  const TextColumn& run() const { return run_; }
  /// What the source calls that column: "test" where the rows are of a run's tests, else "run".
  const std::string& run_word() const { return run_word_; }
  const TextColumn& segment() const { return segment_; }

  /// Precondition: as many values as rows, or the table is empty.
  void set_column(std::string name, std::vector<double> values);
  void set_run(TextColumn run);
  void set_run_word(std::string word) { run_word_ = std::move(word); }
  void set_segment(TextColumn segment);
  /// What was recognised in the files that the table is from, a line each; none for a file that
  /// has the plain form, the house's names and units.
  const std::vector<std::string>& provenance() const { return provenance_; }
  void add_provenance(std::string line) { provenance_.push_back(std::move(line)); }
  /// Remembers why a column of the source is not in the table.
  void set_dropped(std::string name, std::string because);

  /// How many rows of its source a row stands for at most; 1 unless it was read with a limit.
  std::size_t rows_averaged() const { return rows_averaged_; }
  void set_rows_averaged(std::size_t rows) { rows_averaged_ = rows; }

  /// Rows for which `keep` is true, in their order.
  Table select(const std::vector<bool>& keep) const;
  /// Appends the other's rows; columns that one side lacks are NaN there.
  void append(const Table& other);

 private:
  void set_rows(std::size_t rows);

  std::size_t rows_ = 0, rows_averaged_ = 1;
  std::map<std::string, std::vector<double>, std::less<>> columns_;
  std::vector<std::string> provenance_;
  std::map<std::string, std::string, std::less<>> dropped_;
  TextColumn run_, segment_;
  std::string run_word_ = "run";
};

}  // namespace fogbench::model
