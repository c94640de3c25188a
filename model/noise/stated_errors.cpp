#include "model/noise/stated_errors.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/table/median.hpp"

namespace fogbench::model {
namespace {

// A variance of ten samples scatters by this (of its logarithm, squared); nobody states errors of
// fewer, and more scatter than that is the errors' own.
constexpr double kMostChance = 0.2;
// Half of all normal deviates are below this many standard deviations.
constexpr double kHalfOfNormal = 0.6745;

bool states(double error) {
  return error > 0.0 && std::isfinite(error);
}

/// log of error^2 x duration in h, of the rows that state one.
std::vector<double> stated_logarithms(const Windows& windows) {
  std::vector<double> out;
  for (Eigen::Index i = 0; i < windows.white_floor.size(); ++i) {
    const double error = windows.white_floor[i];
    if (states(error)) {
      out.push_back(2.0 * std::log(error) + std::log(windows.duration_s[i] / 3600.0));
    }
  }
  return out;
}

}  // namespace

double stated_white(const Windows& windows) {
  const std::vector<double> stated = stated_logarithms(windows);
  return stated.empty() ? 0.0 : std::exp(0.5 * median(stated));
}

Eigen::VectorXd stated_white_scale(const Windows& windows) {
  Eigen::VectorXd out = Eigen::VectorXd::Ones(windows.rows());
  const std::vector<double> stated = stated_logarithms(windows);
  if (stated.size() < 2) return out;
  const double usual = median(stated);
  double squares = 0.0;
  std::vector<double> steps;
  for (std::size_t i = 0; i < stated.size(); ++i) {
    squares += (stated[i] - usual) * (stated[i] - usual);
    if (i > 0) steps.push_back(std::abs(stated[i] - stated[i - 1]));
  }
  const double whole = squares / static_cast<double>(stated.size());
  if (whole == 0.0) return out;
  const double step = median(std::move(steps)) / kHalfOfNormal;
  const double chance = std::min(0.5 * step * step, kMostChance);
  const double believed = std::max(0.0, 1.0 - chance / whole);
  std::size_t next = 0;
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    if (states(windows.white_floor[i])) out[i] = std::exp(believed * (stated[next++] - usual));
  }
  return out;
}

}  // namespace fogbench::model
