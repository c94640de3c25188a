#pragma once
// The rows that take part in a fit, and how they are weighed: as they are, by standard deviations,
// or whitened by coloured noise. A design's system on them, as rows or as one small triangle.

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "model/fit/design.hpp"
#include "model/noise/noise.hpp"

namespace fogbench::model {

class Observations {
 public:
  /// Rows where the observable, every signal of the design and the weight are given, but for those
  /// of the table that are left out. `weight_by` empty: none. Errors: kBadInput: missing column, no
  /// such rows, a standard deviation that is not positive.
  static Result<Observations> make(const Signals& signals, const Design& design,
                                   const std::string& observable, const std::string& weight_by,
                                   const std::vector<std::size_t>& left_out = {});

  const Design& design() const { return *design_; }
  /// Rows of the signals that take part.
  const std::vector<std::size_t>& taken() const { return taken_; }
  /// One a taken row; empty: unweighted.
  const Eigen::VectorXd& sigma() const { return sigma_; }
  Eigen::VectorXd observed() const;

  /// Averages neighbouring rows of a run down to at most `bins` windows, so that coloured noise can
  /// be estimated on any table; no change when there are no more rows than that.
  /// Errors: kBadInput: a window without a time or a duration, or windows that overlap.
  Status use_windows(std::size_t bins);
  /// Precondition: use_windows succeeded. Their windows, and the bin of each taken row.
  const Windows& windows() const { return windows_; }
  const std::vector<Eigen::Index>& bin_of() const { return bin_of_; }
  /// Length of each taken row's own window, s.
  double length_s(std::size_t taken_row) const {
    return lengths_s_[static_cast<Eigen::Index>(taken_[taken_row])];
  }
  /// The windows of the taken rows themselves. Errors as use_windows.
  Result<Windows> row_windows() const;
  /// The same, or windows that follow each other where these are not to be had.
  Windows row_windows_or_sequence() const;

  /// From now on triangle() works on the windows, whitened.
  void set_whitener(std::shared_ptr<const Whitener> whitener) { whitener_ = std::move(whitener); }

  /// R of [X D y] (reduction.hpp); nothing when a value is not finite at these parameters.
  std::optional<Eigen::MatrixXd> triangle(const Eigen::VectorXd& inner, bool with_tangents) const;
  /// [X D y] on the taken rows, neither weighed nor whitened.
  Eigen::MatrixXd rows(const Eigen::VectorXd& inner, bool with_tangents) const;
  /// [X D y] on the windows, neither weighed nor whitened.
  Eigen::MatrixXd window_rows(const Eigen::VectorXd& inner, bool with_tangents) const;
  /// The first term that is not finite on a taken row, if any, and that row of the table.
  std::optional<std::pair<std::size_t, std::size_t>> not_finite(const Eigen::VectorXd& inner) const;

 private:
  Observations(const Signals& signals, const Design& design)
      : signals_(&signals), design_(&design) {}

  /// Length of each signal row's window: duration_s, else the usual step of time_s, and never more
  /// than the next row's distance; empty where there is no time.
  Eigen::VectorXd window_lengths() const;

  const Signals* signals_;
  const Design* design_;
  std::string observable_;
  std::vector<std::size_t> taken_;
  std::vector<Eigen::Index> place_;  ///< of each signal row among the taken ones, -1: not taken
  Eigen::VectorXd sigma_;
  Eigen::VectorXd lengths_s_;  ///< window_lengths()
  Windows windows_;
  std::vector<Eigen::Index> bin_of_;
  std::shared_ptr<const Whitener> whitener_;  // shared with the noise shapes that made it
};

}  // namespace fogbench::model
