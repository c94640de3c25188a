#include "model/diagnose/calibration.hpp"

#include <algorithm>
#include <cmath>

namespace fogbench::model {

using Eigen::Index;

namespace {

constexpr double kQuantile = 0.95;
// Exceedances above this quantile set the scale of the exponential tail.
constexpr double kTail = 0.80;

double quantile(std::vector<double> values, double level) {
  const auto at = static_cast<std::ptrdiff_t>(level * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

}  // namespace

void Calibration::add(const Eigen::MatrixXd& null) {
  null_.conservativeResize(null.rows(), null_.cols() + null.cols());
  null_.rightCols(null.cols()) = null;
  quantile_.resize(null_.rows());
  for (Index c = 0; c < null_.rows(); ++c) {
    const auto row = null_.row(c);
    quantile_[c] = quantile({row.begin(), row.end()}, kQuantile);
  }
}

double Calibration::p_value(double lead_value, const std::vector<Index>& among) const {
  const Index draws = null_.cols();
  std::vector<double> best(static_cast<std::size_t>(draws), -1e300);
  for (const Index c : among) {
    for (Index b = 0; b < draws; ++b) {
      auto& top = best[static_cast<std::size_t>(b)];
      top = std::max(top, null_(c, b) - quantile_[c]);
    }
  }
  const auto above =
      std::count_if(best.begin(), best.end(), [&](double v) { return v >= lead_value; });
  constexpr long kEnough = 10;
  if (above >= kEnough)
    return (1.0 + static_cast<double>(above)) / (1.0 + static_cast<double>(draws));
  const double start = quantile(best, kTail);
  double mean = 0.0;
  long count = 0;
  for (const double v : best) {
    if (v <= start) continue;
    mean += v - start;
    ++count;
  }
  mean = count > 0 ? mean / static_cast<double>(count) : 2.0;
  return std::min(1.0, (1.0 - kTail) * std::exp(-std::max(0.0, lead_value - start) / mean));
}

}  // namespace fogbench::model
