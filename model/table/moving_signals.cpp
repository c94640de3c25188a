#include "model/table/moving_signals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fogbench::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double least_excitation(std::string_view name) {
  if (name.starts_with("field_")) return 5.0;
  if (name == "temperature_c") return 0.5;
  if (name == "temperature_rate_c_per_h") return 1.0;
  // Ramps of a degree a minute make hundreds; noise of a stated rate makes a few.
  if (name == "temperature_acceleration_c_per_h2") return 30.0;
  if (name == "temperature_gradient_c") return 0.05;
  if (name == "temperature_gradient_rate_c_per_h") return 1.0;
  if (name == "ambient_c") return 0.2;
  if (name == "heater_w") return 0.5;
  if (name == "azimuth_deg") return 1.0;
  if (name == "coil_heat") return 0.004;  // A^2: coils that make 5 uT
  return 0.0;
}

std::optional<MovingSignal> moving_signal(const Signals& signals, std::string_view name,
                                          double least) {
  if (!signals.available(name)) return std::nullopt;
  MovingSignal out{.name = std::string(name), .value = signals.signal(name), .scaled = {}};
  double sum = 0.0;
  Index count = 0;
  out.minimum = std::numeric_limits<double>::infinity();
  out.maximum = -out.minimum;
  for (const double v : out.value) {
    if (!std::isfinite(v)) continue;
    sum += v;
    ++count;
    out.minimum = std::min(out.minimum, v);
    out.maximum = std::max(out.maximum, v);
  }
  if (count < 3 || !(out.span() > std::max(least, 1e-9 * std::abs(out.maximum)))) {
    return std::nullopt;
  }
  const double mean = sum / static_cast<double>(count);
  for (double& v : out.value) v = std::isfinite(v) ? v : mean;
  out.scaled = (2.0 * (out.value.array() - out.minimum) / out.span() - 1.0).matrix();
  return out;
}

std::vector<MovingSignal> moving_signals(const Signals& signals) {
  std::vector<MovingSignal> out;
  for (const std::string_view name :
       {"temperature_c", "temperature_rate_c_per_h", "temperature_gradient_c", "heater_w",
        "ambient_c", "field_x_ut", "field_y_ut", "field_z_ut", "azimuth_deg",
        "time_since_start_s"}) {
    if (auto signal = moving_signal(signals, name, least_excitation(name))) {
      out.push_back(std::move(*signal));
    }
  }
  return out;
}

VectorXd direction(const Signals& signals, const VectorXd& value) {
  // A change smaller than this part of the span is a set point's jitter, not a move.
  const double least = 0.01 * (value.maxCoeff() - value.minCoeff());
  VectorXd out = VectorXd::Zero(value.size());
  for (const Signals::RunRange& run : signals.runs()) {
    double last = value[static_cast<Index>(run.begin)];
    double sign = 0.0;
    for (std::size_t i = run.begin; i < run.end; ++i) {
      const double v = value[static_cast<Index>(i)];
      if (std::abs(v - last) > least) {
        sign = v > last ? 1.0 : -1.0;
        last = v;
      }
      out[static_cast<Index>(i)] = sign;
    }
  }
  return out;
}

MatrixXd legendre(const VectorXd& x, int degree) {
  MatrixXd out(x.size(), degree);
  VectorXd before = VectorXd::Ones(x.size());
  VectorXd now = x;
  for (int n = 1; n <= degree; ++n) {
    out.col(n - 1) = now;
    const VectorXd next =
        ((2.0 * n + 1.0) * x.cwiseProduct(now) - static_cast<double>(n) * before) / (n + 1.0);
    before = now;
    now = next;
  }
  return out;
}

}  // namespace fogbench::model
