#include "model/noise/window_geometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "config/units.hpp"
#include "model/fit/kernels.hpp"

namespace fogbench::model {
namespace {

// Time stamps are rounded: windows that touch may seem to overlap by this part of their length.
constexpr double kOverlapTolerance = 0.01;
// A ladder with a ratio of 4 follows the 1/f spectrum to better than 1 %.
constexpr double kWantedRatio = 4.0;
constexpr int kFewestTerms = 6;
constexpr int kMostTerms = Kernels::kMostStates - 1;  // and the walk

double start_s(const Windows& w, Eigen::Index i) {
  return w.centre_s[i] - 0.5 * w.duration_s[i];
}
double end_s(const Windows& w, Eigen::Index i) {
  return w.centre_s[i] + 0.5 * w.duration_s[i];
}

}  // namespace

double decay_mean(double x) {
  return x > 0.0 ? -std::expm1(-x) / x : 1.0;
}

double decay_double_mean(double x) {
  // The closed form loses x^-2 of its digits; the series' next term is 2 x^6/8!.
  if (x < 0.02) {
    return 1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0 * (1.0 - x / 7.0))));
  }
  return 2.0 * (x + std::expm1(-x)) / (x * x);
}

Status check_windows(const Windows& w) {
  const Eigen::Index n = w.rows();
  if (w.duration_s.size() != n || (w.white_scale.size() != 0 && w.white_scale.size() != n) ||
      w.run_begin.size() < 2 || w.run_begin.front() != 0 ||
      w.run_begin.back() != static_cast<std::size_t>(n)) {
    return config::bad_input(
        "windows: as many durations as rows and the runs' first rows were expected");
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!std::isfinite(w.centre_s[i])) {
      return config::bad_input(
          fmt::format("row {}: time_s is {}, a number was expected", i + 1, w.centre_s[i]));
    }
    if (!(w.duration_s[i] > 0.0) || !std::isfinite(w.duration_s[i])) {
      return config::bad_input(fmt::format(
          "row {}: duration_s is {}, a positive number was expected", i + 1, w.duration_s[i]));
    }
  }
  for (std::size_t run = 0; run + 1 < w.run_begin.size(); ++run) {
    const auto first = static_cast<Eigen::Index>(w.run_begin[run]);
    const auto last = static_cast<Eigen::Index>(w.run_begin[run + 1]);
    for (Eigen::Index i = first + 1; i < last; ++i) {
      const double overlap = end_s(w, i - 1) - start_s(w, i);
      if (w.centre_s[i] <= w.centre_s[i - 1]) {
        return config::bad_input(
            fmt::format("row {}: time_s is {} after {}; rows of a run must be in time order", i + 1,
                        w.centre_s[i], w.centre_s[i - 1]));
      }
      if (overlap > kOverlapTolerance * std::min(w.duration_s[i - 1], w.duration_s[i])) {
        return config::bad_input(fmt::format(
            "rows {} and {}: their averaging windows overlap by {:.3g} s", i, i + 1, overlap));
      }
    }
  }
  return {};
}

FlickerLadder FlickerLadder::for_windows(const Windows& w) {
  double longest_run = 0.0;
  for (std::size_t run = 0; run + 1 < w.run_begin.size(); ++run) {
    if (w.run_begin[run] == w.run_begin[run + 1]) continue;
    const auto first = static_cast<Eigen::Index>(w.run_begin[run]);
    const auto last = static_cast<Eigen::Index>(w.run_begin[run + 1]) - 1;
    longest_run = std::max(longest_run, end_s(w, last) - start_s(w, first));
  }
  const double shortest_tau = w.duration_s.minCoeff() / 10.0;
  const double span = std::log(10.0 * longest_run / shortest_tau);
  const int terms = std::clamp(static_cast<int>(std::ceil(span / std::log(kWantedRatio))) + 1,
                               kFewestTerms, kMostTerms);
  const double log_ratio = span / (terms - 1);
  FlickerLadder ladder;
  ladder.variance_per_b2 = log_ratio / std::numbers::pi;
  for (int j = 0; j < terms; ++j) ladder.tau_s.push_back(shortest_tau * std::exp(j * log_ratio));
  return ladder;
}

Result<std::shared_ptr<const WindowGeometry>> WindowGeometry::make(const Windows& w) {
  if (auto status = check_windows(w); !status) return status.error();
  if (w.rows() == 0) return config::bad_input("no rows to model the noise of");
  auto g = std::make_shared<WindowGeometry>();
  g->ladder = FlickerLadder::for_windows(w);
  g->run_begin = w.run_begin;
  const auto terms = static_cast<Eigen::Index>(g->ladder.tau_s.size());
  const Eigen::Index n = w.rows();
  g->phi.resize(terms, n);
  g->decay.resize(terms, n);
  g->end_cov.resize(terms, n);
  g->mean_spread.resize(n);
  g->mean_total.resize(n);
  g->start_h.resize(n);
  g->step_h.resize(n);
  g->duration_h = w.duration_s.array() / config::kSecondsPerHour;
  g->white_per_n2 = g->duration_h.inverse();
  if (w.white_scale.size() > 0) g->white_per_n2 *= w.white_scale.array();
  const Eigen::Map<const Eigen::ArrayXd> tau(g->ladder.tau_s.data(), terms);
  for (std::size_t run = 0; run + 1 < w.run_begin.size(); ++run) {
    const auto first = static_cast<Eigen::Index>(w.run_begin[run]);
    const auto last = static_cast<Eigen::Index>(w.run_begin[run + 1]);
    for (Eigen::Index i = first; i < last; ++i) {
      const double d = w.duration_s[i];
      const double gap = i + 1 < last ? std::max(0.0, start_s(w, i + 1) - end_s(w, i)) : 0.0;
      const Eigen::ArrayXd x = d / tau;
      const Eigen::ArrayXd phi = x.unaryExpr(&decay_mean);
      const Eigen::ArrayXd psi = x.unaryExpr(&decay_double_mean);
      g->phi.col(i) = phi;
      g->decay.col(i) = (-(d + gap) / tau).exp();
      g->end_cov.col(i) = phi * (-gap / tau).exp() * phi * x;
      g->mean_spread[i] = (psi - phi.square()).sum();
      g->mean_total[i] = psi.sum();
      g->start_h[i] = i == first ? 0.0 : g->start_h[i - 1] + g->step_h[i - 1];
      g->step_h[i] = (d + gap) / config::kSecondsPerHour;
    }
  }
  return std::shared_ptr<const WindowGeometry>(std::move(g));
}

}  // namespace fogbench::model
