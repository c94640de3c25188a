#pragma once
// Running sums that stay exact over millions of samples: every update is relative to the mean so
// far (Welford), so nothing large is ever subtracted from something large.

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

 private:
  std::size_t count_ = 0;
  double mean_t_ = 0.0, mean_y_ = 0.0;
  double sum_tt_ = 0.0, sum_ty_ = 0.0;
};

}  // namespace fogbench::procedures
