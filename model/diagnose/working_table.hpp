#pragma once
// The table as a diagnosis works on it: in order of run and time, a static record joined as a run
// of its own, raw samples averaged into windows so that the work is bounded by the windows, not by
// the rows.
//
// Two resolutions: effects with a memory (hysteresis, lags) are evaluated on the fine rows and then
// averaged over the coarse ones, as the data are. Rows without a measurement (a blank rate) take
// part in the fine ones only: the field that stood there is part of the history.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/model_file.hpp"
#include "config/result.hpp"
#include "model/noise/noise.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// What of a file is worth reading: ten rows for each fine one.
inline constexpr std::size_t kMostRowsToRead = 300'000;

/// 1 in the rows of a joined static record, 0 elsewhere.
inline constexpr const char* kQuietColumn = "quiet_record";

/// temperature_c as it was read, where it was mended.
inline constexpr const char* kReadingsColumn = "temperature_readings_c";

/// Columns that stand in a WorkingTable and in no record.
bool is_made_for_analysis(std::string_view column);

class WorkingTable {
 public:
  /// Errors: kBadInput: no observable, a term of the model without its column, no complete row.
  static Result<WorkingTable> make(const Table& table, const config::ModelFile& model,
                                   const Table* quiet);

  /// At most 30,000 rows; with the static record, if any. The observable is missing in rows that
  /// are there for their history only.
  const Table& fine() const { return fine_; }
  /// At most 800 rows, without the static record: what is fitted, reported and drawn.
  const Table& bench() const { return bench_; }
  /// bench() with the rows that have no measurement between its own, so that an effect with a
  /// memory is fitted as it was searched for; bench() itself where there are none.
  const Table& bench_with_history() const { return history_ ? *history_ : bench_; }
  /// Rows of bench() for rows of bench_with_history() that have a measurement.
  std::vector<std::size_t> bench_rows_of(const std::vector<std::size_t>& rows) const;
  /// The step in which temperature_c was read; 0: none seen.
  double resolution_c() const { return resolution_c_; }
  /// What was mended in the tables, in sentences.
  const std::vector<std::string>& notes() const { return notes_; }
  /// Rows of bench() and then of the static record.
  Eigen::Index rows() const { return static_cast<Eigen::Index>(begin_.size()) - 1; }
  Eigen::Index bench_rows() const { return static_cast<Eigen::Index>(bench_.rows()); }
  bool has_quiet_record() const { return rows() > bench_rows(); }
  std::size_t rows_per_bin() const { return rows_per_bin_; }
  /// Of the coarse rows. Where the table has no usable time, its rows follow each other at 180 s.
  const Windows& windows() const { return windows_; }

  /// Columns on the fine rows, averaged over the coarse ones.
  Eigen::MatrixXd average(const Eigen::MatrixXd& fine_columns) const;

 private:
  /// Columns on the fine rows that have a measurement, averaged over the coarse ones.
  Eigen::MatrixXd average_counted(const Eigen::MatrixXd& columns) const;

  Table fine_, bench_;
  std::optional<Table> history_;
  std::vector<Eigen::Index> counted_;  ///< fine rows that have a measurement
  std::vector<std::size_t> begin_;     ///< of counted_, where each coarse row begins, then its size
  std::vector<std::string> notes_;
  double resolution_c_ = 0.0;
  Windows windows_;
  std::size_t rows_per_bin_ = 1;
};

/// The static record's own bias, as a term of the model.
config::ModelTerm quiet_bias();

}  // namespace fogbench::model
