#pragma once
// Running sums that stay exact over millions of samples: every update is relative to the mean so
// far (Welford), so nothing large is ever subtracted from something large.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace fogbench::procedures {

/// Mean of what was added; NaN entries are missing and skipped.
class Mean {
 public:
  void add(double value) {
    if (std::isnan(value)) return;
    mean_ += (value - mean_) / static_cast<double>(++count_);
  }
  std::size_t count() const { return count_; }
  /// NaN when nothing was added.
  double value() const { return count_ == 0 ? std::numeric_limits<double>::quiet_NaN() : mean_; }

 private:
  std::size_t count_ = 0;
  double mean_ = 0.0;
};

/// Least-squares line y = mean + slope (t - mean t). NaN entries are missing and skipped.
class LineFit {
 public:
  void add(double t, double y) {
    if (std::isnan(y)) return;
    const auto n = static_cast<double>(++count_);
    const double dt = t - mean_t_;
    mean_t_ += dt / n;
    mean_y_ += (y - mean_y_) / n;
    sum_tt_ += dt * (t - mean_t_);
    sum_ty_ += dt * (y - mean_y_);
  }
  std::size_t count() const { return count_; }
  /// NaN when nothing was added.
  double mean() const { return count_ == 0 ? std::numeric_limits<double>::quiet_NaN() : mean_y_; }
  /// Unit of y per unit of t; NaN for fewer than two different t.
  double slope() const {
    return sum_tt_ > 0.0 ? sum_ty_ / sum_tt_ : std::numeric_limits<double>::quiet_NaN();
  }
  double at(double t) const { return mean() + slope() * (t - mean_t_); }
  // Variances of slope() and of at(t) per variance of one entry, when the entries are independent.
  double slope_spread() const { return 1.0 / sum_tt_; }
  double spread(double t) const {
    return 1.0 / static_cast<double>(count_) + (t - mean_t_) * (t - mean_t_) / sum_tt_;
  }

 private:
  std::size_t count_ = 0;
  double mean_t_ = 0.0, mean_y_ = 0.0;
  double sum_tt_ = 0.0, sum_ty_ = 0.0;
};

/// The noise of single entries of a series that is smooth without it, from its second differences:
/// no slope and hardly any curvature enters them. NaN entries are missing and skipped.
class SuccessiveDifferences {
 public:
  void add(double value) {
    if (std::isnan(value)) return;
    const double step = value - last_;
    if (count_ > 0 && step != 0.0) smallest_ = std::min(smallest_, std::abs(step));
    if (++count_ > 2) squares_ += (step - last_step_) * (step - last_step_);
    last_ = value;
    last_step_ = step;
  }
  /// Of one entry; at least that of rounding to the smallest step seen. NaN for fewer than three.
  double variance() const {
    if (count_ < 3) return std::numeric_limits<double>::quiet_NaN();
    const double rounding = std::isfinite(smallest_) ? smallest_ * smallest_ / 12.0 : 0.0;
    return std::max(rounding, squares_ / (6.0 * static_cast<double>(count_ - 2)));
  }

 private:
  std::size_t count_ = 0;
  double last_ = 0.0, last_step_ = 0.0;
  double smallest_ = std::numeric_limits<double>::infinity();
  double squares_ = 0.0;
};

}  // namespace fogbench::procedures
