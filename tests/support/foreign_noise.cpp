#include "tests/support/foreign_noise.hpp"

#include <cassert>
#include <cmath>
#include <map>
#include <numbers>

namespace fogbench::tests {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kHour = 3600.0;

// Flicker noise as Ornstein-Uhlenbeck processes whose times grow by this ratio.
constexpr double kRatio = 3.0;
constexpr double kShortest_s = 1.0;
constexpr double kLongest_s = 3e6;

double begin_s(const World::Window& w) {
  return static_cast<double>(w.begin) * kGridStep;
}
double end_s(const World::Window& w) {
  return static_cast<double>(w.end) * kGridStep;
}

const std::map<std::string, ForeignNoise>& known() {
  static const std::map<std::string, ForeignNoise> all{
      {"white", {.white = 0.002}},
      {"flicker", {.white = 0.001, .flicker = 0.01}},
      {"walk", {.white = 0.002, .walk = 0.02}},
      {"navigation", {.white = 0.001, .flicker = 0.003, .walk = 0.003}},
      {"tactical", {.white = 0.005, .flicker = 0.02, .walk = 0.02}},
      {"fractional", {.white = 0.001, .fractional = 0.0008}},
      {"markov", {.white = 0.001, .markov = 0.005}},
      {"interference", {.white = 0.001, .flicker = 0.003, .walk = 0.003, .interference = 0.002}},
      {"tails", {.white = 0.002, .tails = 4.0}},
      {"heavy_tails", {.white = 0.002, .tails = 3.0}},
      {"poor_rows", {.white = 0.002, .poor_rows = 5.0}},
      {"poor_third", {.white = 0.002, .poor_third = 4.0}},
      {"poor_field", {.white = 0.002, .poor_field = 1.5}},
      {"swing", {.white = 0.002, .white_swing = 0.5}},
      {"quantised", {.white = 0.001, .flicker = 0.003, .walk = 0.003, .quantum_deg = 5e-4}}};
  return all;
}

/// Path of a unit Ornstein-Uhlenbeck process as means over the grid steps, exact: the end and the
/// mean of a step are drawn jointly given its start.
void add_markov(double deviation, double tau_s, VectorXd& path, std::mt19937_64& engine) {
  std::normal_distribution<> normal;
  const double x = kGridStep / tau_s;
  const double decay = std::exp(-x);
  const double phi = -std::expm1(-x) / x;
  const double mean_variance =
      (x > 1e-4 ? 2.0 * (x - 1.0 + decay) / (x * x) : 1.0 - x / 3.0) - phi * phi;
  const double end_deviation = std::sqrt(-std::expm1(-2.0 * x));
  const double mean_on_end = phi * (1.0 - decay) / end_deviation;
  const double mean_alone = std::sqrt(std::max(0.0, mean_variance - mean_on_end * mean_on_end));
  double state = normal(engine);
  for (double& v : path) {
    const double a = normal(engine), b = normal(engine);
    v += deviation * (phi * state + mean_on_end * a + mean_alone * b);
    state = decay * state + end_deviation * a;
  }
}

void add_walk(double per_sqrt_h, VectorXd& path, std::mt19937_64& engine) {
  std::normal_distribution<> normal;
  const double kick = per_sqrt_h * std::sqrt(kGridStep / kHour);
  double state = 0.0;
  for (double& v : path) {
    const double a = normal(engine), b = normal(engine);
    v += state + kick * (a / 2.0 + b / (2.0 * std::sqrt(3.0)));
    state += kick * a;
  }
}

/// Weights of the past in fractionally integrated white noise with the spectrum 1/f^1.5 (Kasdin).
VectorXd fractional_weights(Index n) {
  constexpr double kHalfPower = 0.75;
  VectorXd h(n);
  h[0] = 1.0;
  for (Index k = 1; k < n; ++k) {
    h[k] = h[k - 1] * (static_cast<double>(k) - 1.0 + kHalfPower) / static_cast<double>(k);
  }
  return h;
}

void add_fractional(double deviation, VectorXd& path, std::mt19937_64& engine) {
  std::normal_distribution<> normal;
  const VectorXd h = fractional_weights(path.size());
  for (Index j = 0; j < path.size(); ++j) {
    path.tail(path.size() - j) += deviation * normal(engine) * h.head(path.size() - j);
  }
}

/// How the variance of the integral of a unit Ornstein-Uhlenbeck process grows with time.
double integral_variance(double span_s, double tau_s) {
  const double x = std::abs(span_s) / tau_s;
  const double core = x > 1e-3 ? x + std::expm1(-x) : x * x / 2.0 * (1.0 - x / 3.0 + x * x / 12.0);
  return 2.0 * tau_s * tau_s * core;
}

double markov_covariance(const World::Window& a, const World::Window& b, double tau_s) {
  const auto v = [&](double span_s) { return integral_variance(span_s, tau_s); };
  return 0.5 *
         (v(end_s(b) - begin_s(a)) + v(begin_s(b) - end_s(a)) - v(begin_s(b) - begin_s(a)) -
          v(end_s(b) - end_s(a))) /
         (a.seconds() * b.seconds());
}

/// Of a unit Wiener process that is zero at power-on; `a` is not later than `b`.
double walk_covariance(const World::Window& a, const World::Window& b) {
  const double seconds =
      a.begin == b.begin ? begin_s(a) + a.seconds() / 3.0 : begin_s(a) + a.seconds() / 2.0;
  return seconds / kHour;
}

double sine_covariance(const World::Window& a, const World::Window& b, double period_s) {
  const double omega = 2.0 * std::numbers::pi / period_s;
  const auto share = [&](const World::Window& w) {
    const double x = omega * w.seconds() / 2.0;
    return std::sin(x) / x;
  };
  const double apart = 0.5 * (begin_s(b) + end_s(b) - begin_s(a) - end_s(a));
  return 0.5 * std::cos(omega * apart) * share(a) * share(b);
}

MatrixXd fractional_covariance(const World& world) {
  const auto n = static_cast<Index>(world.size());
  const VectorXd h = fractional_weights(n);
  VectorXd total = VectorXd::Zero(n + 1);  // of the weights before each lag
  for (Index k = 0; k < n; ++k) total[k + 1] = total[k] + h[k];
  MatrixXd response = MatrixXd::Zero(static_cast<Index>(world.windows.size()), n);
  for (Index row = 0; row < response.rows(); ++row) {
    const World::Window& w = world.windows[static_cast<std::size_t>(row)];
    const auto begin = static_cast<Index>(w.begin), end = static_cast<Index>(w.end);
    for (Index j = 0; j < end; ++j) {
      response(row, j) = (total[end - j] - total[std::max<Index>(begin - j, 0)]) /
                         static_cast<double>(end - begin);
    }
  }
  return response * response.transpose();
}

}  // namespace

ForeignNoise foreign_noise(const std::string& name) {
  const auto found = known().find(name);
  assert(found != known().end());
  return found->second;
}

std::vector<std::string> noises_of_the_family() {
  return {"white", "flicker", "walk", "navigation", "tactical"};
}

std::vector<std::string> noises_outside_the_family() {
  return {"fractional", "markov", "interference", "tails", "swing", "quantised"};
}

std::vector<std::string> noises_that_differ_by_row() {
  return {"poor_rows", "poor_third", "poor_field", "heavy_tails"};
}

double white_deviation(const ForeignNoise& noise, const World& world, const World::Window& window) {
  const double middle = 0.5 * static_cast<double>(window.begin + window.end);
  const double turn = 2.0 * std::numbers::pi * middle / static_cast<double>(world.size());
  double level = 1.0 + noise.white_swing * std::sin(turn);
  // A fifth of the windows, by a hash of where they begin.
  if ((window.begin * 2654435761u >> 7) % 5 == 0) level *= noise.poor_rows;
  if (3.0 * middle > 2.0 * static_cast<double>(world.size())) level *= noise.poor_third;
  if (noise.poor_field > 0.0) {
    double squares = 0.0;
    for (const auto& axis : world.field_ut) squares += std::pow(world.mean(axis, window), 2);
    level *= 1.0 + noise.poor_field * std::sqrt(squares) / 100.0;
  }
  return noise.white / std::sqrt(window.seconds() / kHour) * level;
}

VectorXd draw_noise(const ForeignNoise& noise, const World& world, std::mt19937_64& engine) {
  std::normal_distribution<> normal;
  std::uniform_real_distribution<> uniform;
  VectorXd path = VectorXd::Zero(static_cast<Index>(world.size()));
  if (noise.flicker > 0.0) {
    const double deviation = noise.flicker * std::sqrt(std::log(kRatio) / std::numbers::pi);
    for (double tau = kShortest_s; tau < kLongest_s; tau *= kRatio) {
      add_markov(deviation, tau, path, engine);
    }
  }
  if (noise.walk > 0.0) add_walk(noise.walk, path, engine);
  if (noise.fractional > 0.0) add_fractional(noise.fractional, path, engine);
  if (noise.markov > 0.0) add_markov(noise.markov, noise.markov_tau_s, path, engine);

  const double phase = 2.0 * std::numbers::pi * uniform(engine);
  std::map<std::size_t, double> rounding;  // of the angle at each instant that bounds a window
  const auto rounded = [&](std::size_t step) {
    return rounding.try_emplace(step, (uniform(engine) - 0.5) * noise.quantum_deg).first->second;
  };
  VectorXd out(static_cast<Index>(world.windows.size()));
  for (Index row = 0; row < out.size(); ++row) {
    const World::Window& w = world.windows[static_cast<std::size_t>(row)];
    const auto steps = static_cast<Index>(w.end - w.begin);
    double unit = normal(engine);
    if (noise.tails > 2.0) {
      std::student_t_distribution<> tailed(noise.tails);
      unit = tailed(engine) * std::sqrt((noise.tails - 2.0) / noise.tails);
    }
    out[row] = path.segment(static_cast<Index>(w.begin), steps).mean() +
               white_deviation(noise, world, w) * unit;
    if (noise.interference > 0.0) {
      const double omega = 2.0 * std::numbers::pi / noise.interference_period_s;
      out[row] += noise.interference *
                  (std::cos(omega * begin_s(w) + phase) - std::cos(omega * end_s(w) + phase)) /
                  (omega * w.seconds());
    }
    if (noise.quantum_deg > 0.0) {
      const double before = rounded(w.begin), after = rounded(w.end);
      out[row] += (after - before) / (w.seconds() / kHour);
    }
  }
  return out;
}

MatrixXd noise_covariance(const ForeignNoise& noise, const World& world) {
  const auto n = static_cast<Index>(world.windows.size());
  MatrixXd out = MatrixXd::Zero(n, n);
  if (noise.fractional > 0.0) {
    out = noise.fractional * noise.fractional * fractional_covariance(world);
  }
  const double rounding = noise.quantum_deg * noise.quantum_deg / 12.0;
  for (Index i = 0; i < n; ++i) {
    const World::Window& a = world.windows[static_cast<std::size_t>(i)];
    out(i, i) += std::pow(white_deviation(noise, world, a), 2) +
                 2.0 * rounding / std::pow(a.seconds() / kHour, 2);
    for (Index j = i; j < n; ++j) {
      const World::Window& b = world.windows[static_cast<std::size_t>(j)];
      double v = 0.0;
      for (double tau = kShortest_s; noise.flicker > 0.0 && tau < kLongest_s; tau *= kRatio) {
        v += noise.flicker * noise.flicker * std::log(kRatio) / std::numbers::pi *
             markov_covariance(a, b, tau);
      }
      v += noise.walk * noise.walk * walk_covariance(a, b);
      v += noise.markov * noise.markov * markov_covariance(a, b, noise.markov_tau_s);
      v += noise.interference * noise.interference *
           sine_covariance(a, b, noise.interference_period_s);
      if (j > i && a.end == b.begin) {
        v -= rounding / (a.seconds() * b.seconds() / (kHour * kHour));
      }
      out(i, j) += v;
      if (j > i) out(j, i) = out(i, j);
    }
  }
  return out;
}

}  // namespace fogbench::tests
