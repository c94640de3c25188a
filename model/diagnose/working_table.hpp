#pragma once
// The table as a diagnosis works on it: in order of run and time, complete rows only, a static
// record joined as a run of its own, raw samples averaged into windows so that the work is bounded
// by the windows, not by the rows.
//
// Two resolutions: effects with a memory (hysteresis, lags) are evaluated on the fine rows and then
// averaged over the coarse ones, as the data are.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "config/model_file.hpp"
#include "config/result.hpp"
#include "model/noise.hpp"
#include "model/table.hpp"

namespace fogbench::model {

/// What of a file is worth reading: ten rows for each fine one.
inline constexpr std::size_t kMostRowsToRead = 300'000;

/// 1 in the rows of a joined static record, 0 elsewhere.
inline constexpr const char* kQuietColumn = "quiet_record";

class WorkingTable {
 public:
  /// Errors: kBadInput: no observable, a term of the model without its column, no complete row.
  static Result<WorkingTable> make(const Table& table, const config::ModelFile& model,
                                   const Table* quiet);

  /// At most 30,000 rows; with the static record, if any.
  const Table& fine() const { return fine_; }
  /// At most 800 rows, without the static record: what is fitted, reported and drawn.
  const Table& bench() const { return bench_; }
  /// Rows of bench() and then of the static record.
  Eigen::Index rows() const { return static_cast<Eigen::Index>(begin_.size()) - 1; }
  Eigen::Index bench_rows() const { return static_cast<Eigen::Index>(bench_.rows()); }
  bool has_quiet_record() const { return rows() > bench_rows(); }
  std::size_t rows_per_bin() const { return rows_per_bin_; }
  /// Of the coarse rows. Where the table has no usable time, its rows follow each other at 1 s.
  const Windows& windows() const { return windows_; }

  /// Columns on the fine rows, averaged over the coarse ones.
  Eigen::MatrixXd average(const Eigen::MatrixXd& fine_columns) const;

 private:
  Table fine_, bench_;
  std::vector<std::size_t> begin_;  ///< fine rows of each coarse row, then their number
  Windows windows_;
  std::size_t rows_per_bin_ = 1;
};

/// The static record's own bias, as a term of the model.
config::ModelTerm quiet_bias();

}  // namespace fogbench::model
