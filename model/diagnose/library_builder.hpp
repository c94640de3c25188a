#pragma once
// How a library grows.

#include <string>
#include <vector>

#include "model/diagnose/library.hpp"

namespace fogbench::model {

/// Grows a library column by column.
class LibraryBuilder {
 public:
  explicit LibraryBuilder(const LibrarySource& source) : source_(source) {}

  const LibrarySource& source() const { return source_; }
  const Signals& signals() const { return source_.signals; }

  /// Columns on the fine rows; missing entries count as zero, and so does the static record, which
  /// informs the noise only.
  Eigen::MatrixXd averaged(Eigen::MatrixXd fine_columns) const;
  /// Columns on the coarse rows; all-zero and non-finite ones are left out.
  void add_block(Candidate& candidate, const Eigen::MatrixXd& columns, double inner = 0.0,
                 std::size_t shape = 0);
  /// `columns` on the fine rows.
  void add_shadow(std::string name, const Eigen::MatrixXd& fine_columns);
  /// Unless it has no block.
  void add(Candidate candidate);
  /// With a block for each of its shapes at each value of its inner parameter; refused where all of
  /// them are zero.
  void add_on_grid(Candidate candidate, const std::vector<double>& grid);
  void refuse(std::string effect, std::string because);
  Library finish();

 private:
  const LibrarySource& source_;
  Library library_;
  Eigen::Index count_ = 0;
  std::vector<Eigen::MatrixXd> parts_;
};

}  // namespace fogbench::model
