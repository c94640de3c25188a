#include "model/diagnose/loop_figures.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/effects/catalogue.hpp"
#include "model/effects/loop.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Rows of one branch, an even number: one of them is in the middle.
constexpr Index kBranch = 400;
/// Of a number's share, for derivatives.
constexpr double kSmallShare = 1e-3;

/// An input that goes up, which makes a memory forget where it began, then down and up again.
Table driven_between(double low, double high, std::string_view signal) {
  std::vector<double> u;
  for (Index i = 0; i <= 3 * kBranch; ++i) {
    const double share = static_cast<double>(i % (2 * kBranch)) / kBranch;
    u.push_back(low + (high - low) * (share < 1.0 ? share : 2.0 - share));
  }
  Table out;
  out.set_column(std::string(signal), std::move(u));
  return out;
}

struct Branches {
  VectorXd u, rising, falling;  ///< from the lowest input to the highest
};

/// {half the gap in the middle, half the way between the branches at half height}.
Eigen::Vector2d measured(const Branches& loop) {
  const Index middle = kBranch / 2;
  const double gap = loop.falling[middle] - loop.rising[middle];
  const double level = 0.5 * (loop.falling[middle] + loop.rising[middle]);
  // The crossing that lies nearest to the middle.
  const auto crossing = [&](const VectorXd& branch) {
    double nearest = kMissing;
    for (Index i = 0; i < kBranch; ++i) {
      const double a = branch[i] - level, b = branch[i + 1] - level;
      if (a * b > 0.0 || a == b) continue;
      const double at = loop.u[i] + (loop.u[i + 1] - loop.u[i]) * a / (a - b);
      if (!(std::abs(at - loop.u[middle]) >= std::abs(nearest - loop.u[middle]))) nearest = at;
    }
    return nearest;
  };
  return {0.5 * gap, 0.5 * std::abs(crossing(loop.rising) - crossing(loop.falling))};
}

}  // namespace

std::optional<LoopFigures> loop_figures(const FitResult& fit, std::string_view term,
                                        const Table& table) {
  const Effect* effect = find_effect(term);
  if (effect == nullptr) return {};
  const EffectInfo& info = effect->info();
  if (info.form_of.empty() && effects::loops_of(info.id).empty()) return {};

  std::vector<double> coefficients, inner;
  std::vector<Index> free;  // of coefficients and inner parameters in the covariance; -1: held
  Index next = 0;
  const Estimate* any = nullptr;
  for (const Estimate& e : fit.estimates) {
    const Index at = e.held ? -1 : next++;
    if (e.name != term && !e.name.starts_with(std::string(term) + ".")) continue;
    (e.inner ? inner : coefficients).push_back(std::isfinite(e.value) ? e.value : 0.0);
    free.push_back(at);
    any = &e;
  }
  if (coefficients.size() != info.columns.size() || inner.size() != info.parameters.size()) {
    return {};
  }
  const std::string_view signal = info.signals.front();
  const auto values = table.column(signal);
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  const bool field = signal.starts_with("field_");
  if (field) {
    high = std::max(std::abs(low), std::abs(high));
    low = -high;
  }
  if (!(low < high)) return {};
  const Table driven = driven_between(low, high, signal);
  const Signals signals(driven, fit.fitted.reference_temperature_c);
  const auto figures = [&](const std::vector<double>& all) {
    const auto own = static_cast<Index>(coefficients.size());
    const std::vector<double> at(all.begin() + own, all.end());
    const VectorXd y = effect->regressor(signals, at) * VectorXd::Map(all.data(), own);
    return measured({signals.signal(signal).head(kBranch + 1), y.segment(2 * kBranch, kBranch + 1),
                     y.segment(kBranch, kBranch + 1).reverse()});
  };
  std::vector<double> all = coefficients;
  all.insert(all.end(), inner.begin(), inner.end());
  const Eigen::Vector2d value = figures(all);
  Eigen::Vector2d variance = Eigen::Vector2d::Zero();
  MatrixXd gradient = MatrixXd::Zero(2, fit.covariance.cols());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (free[i] < 0 || all[i] == 0.0) continue;
    std::vector<double> up = all, down = all;
    const double step = kSmallShare * std::abs(all[i]);
    up[i] += step;
    down[i] -= step;
    gradient.col(free[i]) = (figures(up) - figures(down)) / (2.0 * step);
  }
  for (Index row = 0; row < 2; ++row) {
    for (Index i = 0; i < gradient.cols(); ++i) {
      for (Index j = 0; j < gradient.cols(); ++j) {
        const double share = gradient(row, i) * gradient(row, j);
        if (share != 0.0) variance[row] += share * fit.covariance(i, j);
      }
    }
  }
  return LoopFigures{{"remanence", "deg/h", value[0], std::sqrt(variance[0]), any->coverage_factor},
                     {field ? "coercive_field" : "half_width", field ? "uT" : "degC", value[1],
                      std::sqrt(variance[1]), any->coverage_factor}};
}

}  // namespace fogbench::model
