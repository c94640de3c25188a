#include "acceptance/set_points.hpp"

#include <cmath>

#include "model/compare/contrast.hpp"
#include "model/table/table.hpp"

namespace fogbench::acceptance {
using procedures::Point;
using procedures::PointKind;

namespace {

/// The averages of one set point and the baseline before them.
struct Group {
  const Point* baseline = nullptr;
  std::vector<const Point*> averages;

  bool takes(const Point& point) const {
    return point.segment == averages.front()->segment &&
           point.target_c == averages.front()->target_c;
  }
};

std::vector<Group> groups_of(std::span<const Point> points) {
  std::vector<Group> groups;
  const Point* baseline = nullptr;
  for (const Point& point : points) {
    if (point.kind == PointKind::kBaseline) baseline = &point;
    // A thermostat that is off has a target all the same.
    const bool at_set_point = point.kind == PointKind::kAverage && std::isnan(point.field_set_ut) &&
                              std::isfinite(point.target_c) && point.heater_w > 0.0;
    if (!at_set_point) continue;
    if (groups.empty() || groups.back().baseline != baseline || !groups.back().takes(point)) {
      groups.push_back({.baseline = baseline});
    }
    groups.back().averages.push_back(&point);
  }
  return groups;
}

Result<double> deviation_error(const Group& group, const model::FitResult& fit) {
  const auto window = [](const Point& point, double weight) {
    return model::WeightedWindow{weight, point.time_s, point.duration_s,
                                 point.rate_std_error_deg_per_h};
  };
  std::vector<model::WeightedWindow> windows{window(*group.baseline, -1.0)};
  for (const Point* point : group.averages) {
    windows.push_back(window(*point, 1.0 / static_cast<double>(group.averages.size())));
  }
  return model::contrast_standard_error(std::move(windows), fit);
}

}  // namespace

Result<std::vector<SetPoint>> set_points_of(std::span<const Point> points,
                                            const model::FitResult* fit) {
  std::vector<SetPoint> out;
  for (const Group& group : groups_of(points)) {
    const auto n = static_cast<double>(group.averages.size());
    double rate = 0.0, temperature = 0.0, squares = 0.0;
    for (const Point* point : group.averages) {
      rate += point->rate_deg_per_h / n;
      temperature += point->temperature_c / n;
    }
    for (const Point* point : group.averages) {
      squares += (point->rate_deg_per_h - rate) * (point->rate_deg_per_h - rate);
    }
    SetPoint set_point{
        .segment = group.averages.front()->segment,
        .target_c = group.averages.front()->target_c,
        .temperature_c = temperature,
        .averages = group.averages.size(),
        .deviation_deg_per_h = {model::kMissing, model::kMissing},
        .sigma_deg_per_h = n > 1.0 ? std::sqrt(squares / (n - 1.0)) : model::kMissing};
    if (group.baseline != nullptr) {
      set_point.deviation_deg_per_h.value = rate - group.baseline->rate_deg_per_h;
      if (fit != nullptr) {
        const auto error = deviation_error(group, *fit);
        if (!error) return error.error();
        set_point.deviation_deg_per_h.standard_error = *error;
      }
    }
    out.push_back(std::move(set_point));
  }
  return out;
}

PooledSigma pooled_sigma(const std::vector<SetPoint>& set_points) {
  double squares = 0.0, degrees = 0.0;
  for (const SetPoint& set_point : set_points) {
    if (std::isnan(set_point.sigma_deg_per_h)) continue;
    const auto own = static_cast<double>(set_point.averages - 1);
    squares += own * set_point.sigma_deg_per_h * set_point.sigma_deg_per_h;
    degrees += own;
  }
  if (degrees == 0.0) return {{model::kMissing, model::kMissing}, 0.0};
  const double sigma = std::sqrt(squares / degrees);
  return {{sigma, sigma / std::sqrt(2.0 * degrees)}, degrees};
}

}  // namespace fogbench::acceptance
