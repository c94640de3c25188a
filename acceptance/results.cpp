#include "acceptance/results.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace fogbench::acceptance {
using procedures::Point;
using procedures::PointKind;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr Figure kUnknown{kNaN, kNaN};
constexpr double kReferenceFieldUt = 100.0;  // coefficients are per 100 uT

std::array<double, 3> field_of(const Point& point) {
  return {point.field_x_ut, point.field_y_ut, point.field_z_ut};
}

/// The axis along which the measured field ranges most.
std::size_t swept_axis(std::span<const Point* const> sweep) {
  std::array<double, 3> range{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Point* point : sweep) {
      const double field = field_of(*point)[axis];
      if (std::isnan(field)) continue;
      low = std::min(low, field);
      high = std::max(high, field);
    }
    range[axis] = high - low;
  }
  return static_cast<std::size_t>(std::max_element(range.begin(), range.end()) - range.begin());
}

Figure extreme_slope(const Point& low, const Point& high) {
  const double span = (high.field_set_ut - low.field_set_ut) / kReferenceFieldUt;
  if (!(span > 0.0)) return kUnknown;
  return {(high.rate_deg_per_h - low.rate_deg_per_h) / span,
          std::hypot(high.rate_std_error_deg_per_h, low.rate_std_error_deg_per_h) / span};
}

struct Line {
  Figure slope = kUnknown, intercept = kUnknown;
};

/// y = intercept + slope x with standard errors from the residuals; unknown for fewer than three
/// points or a constant x.
Line least_squares(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  if (x.size() < 3) return {};
  double mean_x = 0.0, mean_y = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / n;
    mean_y += y[i] / n;
  }
  double sxx = 0.0, sxy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sxx += (x[i] - mean_x) * (x[i] - mean_x);
    sxy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  if (!(sxx > 0.0)) return {};
  const double slope = sxy / sxx;
  const double intercept = mean_y - slope * mean_x;
  double squares = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double residual = y[i] - intercept - slope * x[i];
    squares += residual * residual;
  }
  const double variance = squares / (n - 2.0);
  return {{slope, std::sqrt(variance / sxx)},
          {intercept, std::sqrt(variance * (1.0 / n + mean_x * mean_x / sxx))}};
}

/// First, middle and last zero-field reading of a sweep 0, +, 0, -, 0; empty for another shape.
std::optional<std::array<const Point*, 3>> zeros_of(std::span<const Point* const> sweep) {
  std::vector<const Point*> zeros;
  for (const Point* point : sweep) {
    if (point->field_set_ut == 0.0) zeros.push_back(point);
  }
  if (zeros.size() != 3) return {};
  return std::array{zeros[0], zeros[1], zeros[2]};
}

std::string sweep_of(const Point& point) {
  return point.segment.substr(0, point.segment.find('/'));
}

/// The sweep's figures; `baseline` is NaN when there was none.
SweepResult sweep_result(std::span<const Point* const> sweep, std::size_t axis, double baseline) {
  SweepResult result;
  result.test = sweep.front()->test;
  result.sweep = sweep_of(*sweep.front());
  result.axis = "xyz"[axis];
  result.points = sweep.size();
  const auto by_level = [](const Point* a, const Point* b) {
    return a->field_set_ut < b->field_set_ut;
  };
  const auto [low, high] = std::minmax_element(sweep.begin(), sweep.end(), by_level);
  result.lowest = **low;
  result.highest = **high;
  result.k_deg_per_h = extreme_slope(result.lowest, result.highest);
  std::vector<double> field, rate;
  for (const Point* point : sweep) {
    const double measured = field_of(*point)[axis] / kReferenceFieldUt;
    if (std::isnan(measured) || std::isnan(point->rate_deg_per_h)) continue;
    field.push_back(measured);
    rate.push_back(point->rate_deg_per_h);
  }
  const Line line = least_squares(field, rate);
  result.slope_deg_per_h = line.slope;
  result.intercept_deg_per_h = {line.intercept.value - baseline, line.intercept.standard_error};

  result.zero_first_deg_per_h = result.zero_middle_deg_per_h = result.zero_last_deg_per_h = kNaN;
  result.drift_deg_per_h = result.closure_deg_per_h = kUnknown;
  if (const auto zeros = zeros_of(sweep)) {
    const auto& [first, middle, last] = *zeros;
    const double e0 = first->rate_std_error_deg_per_h, e12 = middle->rate_std_error_deg_per_h,
                 e24 = last->rate_std_error_deg_per_h;
    result.zero_first_deg_per_h = first->rate_deg_per_h - baseline;
    result.zero_middle_deg_per_h = middle->rate_deg_per_h - baseline;
    result.zero_last_deg_per_h = last->rate_deg_per_h - baseline;
    result.drift_deg_per_h = {last->rate_deg_per_h - first->rate_deg_per_h, std::hypot(e0, e24)};
    result.closure_deg_per_h = {
        first->rate_deg_per_h - 2.0 * middle->rate_deg_per_h + last->rate_deg_per_h,
        std::hypot(e0, 2.0 * e12, e24)};
  }
  return result;
}

}  // namespace

RunResults derive_results(std::span<const Point> points) {
  RunResults results;
  const Point* baseline = nullptr;
  std::vector<const Point*> sweep;  // of one axis in one test, so far

  const auto deviation = [&](const Point& point) {
    Deviation row;
    row.test = point.test;
    row.segment = point.segment;
    row.time_s = point.time_s;
    row.target_c = point.target_c;
    row.temperature_c = point.temperature_c;
    row.field_set_ut = point.field_set_ut;
    row.field_ut = kNaN;
    row.rate_deg_per_h = point.rate_deg_per_h;
    row.deviation_deg_per_h = kUnknown;
    if (baseline != nullptr) {
      row.deviation_deg_per_h = {
          point.rate_deg_per_h - baseline->rate_deg_per_h,
          std::hypot(point.rate_std_error_deg_per_h, baseline->rate_std_error_deg_per_h)};
    }
    return row;
  };
  const auto close_sweep = [&] {
    if (sweep.empty()) return;
    const std::size_t axis = swept_axis(sweep);
    for (const Point* point : sweep) {
      results.magnetic.push_back(deviation(*point));
      results.magnetic.back().field_ut = field_of(*point)[axis];
    }
    results.sweeps.push_back(
        sweep_result(sweep, axis, baseline == nullptr ? kNaN : baseline->rate_deg_per_h));
    sweep.clear();
  };

  for (const Point& point : points) {
    const bool in_sweep = point.kind == PointKind::kAverage && !std::isnan(point.field_set_ut);
    if (!in_sweep || (!sweep.empty() && (sweep.front()->test != point.test ||
                                         sweep_of(*sweep.front()) != sweep_of(point)))) {
      close_sweep();
    }
    if (baseline != nullptr && baseline->test != point.test) baseline = nullptr;
    if (point.kind == PointKind::kBaseline) {
      baseline = &point;
    } else if (in_sweep) {
      sweep.push_back(&point);
    } else if (point.kind == PointKind::kAverage) {
      results.temperature.push_back(deviation(point));
    }
  }
  close_sweep();
  return results;
}

}  // namespace fogbench::acceptance
