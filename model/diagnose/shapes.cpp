#include "model/diagnose/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "config/units.hpp"
#include "model/effects/history.hpp"
#include "model/median.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr const char* kRate = "temperature_rate_c_per_h";
constexpr const char* kAcceleration = "temperature_acceleration_c_per_h2";

/// Elementary loops of a relaxing one, in widths, up to where exp(-width) no longer counts.
constexpr int kLoops = 12;
constexpr double kWidestLoop = 4.0;

/// A loop that relaxes exponentially with the way that u has gone since its reversal: a sum of play
/// operators with exponentially distributed widths (Prandtl-Ishlinskii). It starts where u starts.
VectorXd relaxing_loop(const Signals& signals, const VectorXd& u, double width) {
  VectorXd out = VectorXd::Zero(u.size());
  double weights = 0.0;
  for (int k = 0; k < kLoops; ++k) {
    const double relative = (k + 0.5) * kWidestLoop / kLoops;
    const double weight = std::exp(-relative);
    weights += weight;
    for (const Signals::RunRange& run : signals.runs()) {
      double state = u[static_cast<Index>(run.begin)];
      for (std::size_t i = run.begin; i < run.end; ++i) {
        const auto row = static_cast<Index>(i);
        state = std::min(std::max(state, u[row] - relative * width), u[row] + relative * width);
        out[row] += weight * state;
      }
    }
  }
  return out / weights;
}

/// A magnetisation that relaxes towards the field with the way that the field has gone:
/// dm = (u - m) |du| / width. In a steady sweep it cannot be told from a lag in time.
VectorXd path_lag(const Signals& signals, const VectorXd& u, double width) {
  VectorXd out(u.size());
  for (const Signals::RunRange& run : signals.runs()) {
    double m = u[static_cast<Index>(run.begin)], before = m;
    for (std::size_t i = run.begin; i < run.end; ++i) {
      const auto row = static_cast<Index>(i);
      // Exact for a u that moves evenly from the one row to the next.
      const double step = u[row] - before;
      const double way = std::abs(step) / width;
      if (way > 0.0) {
        const double behind = step / way;
        m = u[row] - behind + (m - before + behind) * std::exp(-way);
      }
      before = u[row];
      out[row] = m;
    }
  }
  return out;
}

/// The windows follow each other without a gap.
bool adjoin(const Signals& signals, Index a, Index b) {
  constexpr double kMostGap = 0.1;  // of a window
  const auto time = signals.signal("time_s");
  const auto duration = signals.signal("duration_s");
  const double between = time[b] - time[a] - 0.5 * (duration[a] + duration[b]);
  const double shorter = std::min(duration[a], duration[b]);
  return shorter > 0.0 && std::abs(between) < kMostGap * shorter;
}

/// Rate of each window from the temperatures at its ends, where windows follow each other without
/// a gap; elsewhere as the table states it. A boundary's temperature is the middle of what the two
/// windows make of it. At kinks this is closer to the mean rate than a least-squares slope.
std::vector<double> rate_between_ends(const Signals& signals) {
  const auto rate = signals.signal(kRate);
  const auto temperature = signals.signal("temperature_c");
  const auto duration = signals.signal("duration_s");
  std::vector<double> out(rate.begin(), rate.end());
  const auto boundary = [&](Index a, Index b) {
    const double half_a = 0.5 * duration[a] / config::kSecondsPerHour;
    const double half_b = 0.5 * duration[b] / config::kSecondsPerHour;
    return 0.5 * (temperature[a] + rate[a] * half_a + temperature[b] - rate[b] * half_b);
  };
  for (const Signals::RunRange& run : signals.runs()) {
    for (std::size_t i = run.begin + 1; i + 1 < run.end; ++i) {
      const auto row = static_cast<Index>(i);
      if (!adjoin(signals, row - 1, row) || !adjoin(signals, row, row + 1)) continue;
      out[i] = (boundary(row, row + 1) - boundary(row - 1, row)) * config::kSecondsPerHour /
               duration[row];
    }
  }
  return out;
}

/// Mean acceleration of each window from the rates at its ends. A boundary's rate is 2 x the slope
/// between the two windows' means less the mean of their own rates, which is exact for a cubic.
std::vector<double> acceleration_between_ends(const Signals& signals) {
  const auto rate = signals.signal(kRate);
  const auto temperature = signals.signal("temperature_c");
  const auto time = signals.signal("time_s");
  const auto stated = signals.signal(kAcceleration);
  std::vector<double> out(stated.begin(), stated.end());
  const auto boundary = [&](Index a, Index b) {
    const double hours = (time[b] - time[a]) / config::kSecondsPerHour;
    return 2.0 * (temperature[b] - temperature[a]) / hours - 0.5 * (rate[a] + rate[b]);
  };
  for (const Signals::RunRange& run : signals.runs()) {
    for (std::size_t i = run.begin + 1; i + 1 < run.end; ++i) {
      const auto row = static_cast<Index>(i);
      if (!adjoin(signals, row - 1, row) || !adjoin(signals, row, row + 1)) continue;
      const double hours = 0.5 * (time[row + 1] - time[row - 1]) / config::kSecondsPerHour;
      out[i] = (boundary(row, row + 1) - boundary(row - 1, row)) / hours;
    }
  }
  return out;
}

/// The lagged rate from the temperature alone, LPF(dT/dt) = (T - LPF(T)) / tau: no derivative is
/// taken, so it is good between windows too, where a rate of window means is smeared.
VectorXd lagged_rate_of_means(const Signals& signals, double tau_s) {
  using namespace effects;
  const VectorXd t = signals.signal("temperature_c");
  return (t - lag(signals, t, tau_s, Gap::kLinear)) * (config::kSecondsPerHour / tau_s);
}

/// A table with one column made anew. Shared by the shapes that were made of it.
struct Reconstruction {
  Reconstruction(const Signals& from, const char* column, std::vector<double> values)
      : table(with(from.table(), column, std::move(values))),
        signals(table, from.reference_temperature_c()) {}

  static Table with(Table table, const char* column, std::vector<double> values) {
    table.set_column(column, std::move(values));
    return table;
  }

  const Table table;
  const Signals signals;
};

/// Half of it is a lag that lies within what averaging leaves open: the instants at which a logger
/// takes the temperatures of a window's two ends.
double usual_duration(const Signals& signals) {
  const auto given = signals.signal("duration_s");
  return std::max(median({given.begin(), given.end()}), 1.0);
}

std::vector<double> parameters_of(double first, const std::vector<double>& further) {
  std::vector<double> all{first};
  all.insert(all.end(), further.begin(), further.end());
  return all;
}

/// The same columns with those of the memory's beginnings after them.
Shape with_starts(Shape shape, const Effect& effect, const Signals& signals,
                  const std::vector<double>& further = {}) {
  return [shape = std::move(shape), &effect, &signals, further](double inner) {
    const MatrixXd own = shape(inner);
    const MatrixXd starts = effect.starts(signals, parameters_of(inner, further));
    MatrixXd out(own.rows(), own.cols() + starts.cols());
    out << own, starts;
    return out;
  };
}

VectorXd field(const Signals& signals, std::string_view effect) {
  return signals.signal(std::string("field_") + effect.back() + "_ut") / kFieldUnitUt;
}

std::vector<Shape> shapes_at_rest(const Effect& effect, const Signals& signals) {
  const auto own = [&effect](const Signals& from, double inner) {
    const std::vector<double> parameters(effect.info().parameters.empty() ? 0 : 1, inner);
    return effect.regressor(from, parameters);
  };
  std::vector<Shape> out{[own, &signals](double inner) { return own(signals, inner); }};
  const std::string_view id = effect.info().id;
  if (id.starts_with("magnetic_hysteresis_")) {
    const VectorXd h = field(signals, id);
    out.push_back(
        [&signals, h](double width) -> MatrixXd { return relaxing_loop(signals, h, width); });
    out.push_back([&signals, h](double width) -> MatrixXd { return path_lag(signals, h, width); });
  } else if (id == "temperature_hysteresis") {
    out.push_back([&signals](double width) -> MatrixXd {
      return relaxing_loop(signals, signals.signal("temperature_c"), width);
    });
  } else if (id == "coil_heating") {
    // The copper warms the bench, and the bench the gyro: two equal poles.
    out.push_back([&signals](double tau) -> MatrixXd {
      using namespace effects;
      const VectorXd bench =
          lag(signals, signals.signal("coil_heat"), 0.5 * tau, Gap::kStepped, LagStart::kZero);
      return lag(signals, bench, 0.5 * tau, Gap::kLinear, LagStart::kZero);
    });
  } else if (id.starts_with("magnetic_saturation_")) {
    out.push_back([h = field(signals, id)](double scale) -> MatrixXd {
      return (h.array() / scale).atan().matrix();
    });
  } else if (id.starts_with("temperature_rate") || id == "temperature_acceleration") {
    if (!signals.available("temperature_c") || !signals.available("time_s")) return out;
    const bool rate = id != "temperature_acceleration";
    const auto other = std::make_shared<const Reconstruction>(
        signals, rate ? kRate : kAcceleration,
        rate ? rate_between_ends(signals) : acceleration_between_ends(signals));
    out.push_back([own, other](double inner) { return own(other->signals, inner); });
    if (id == "temperature_rate_lagged") {
      out.push_back(
          [&signals](double tau) -> MatrixXd { return lagged_rate_of_means(signals, tau); });
    }
    if (id == "temperature_rate") {
      out.push_back([&signals, tau = 0.5 * usual_duration(signals)](double) {
        return find_effect("temperature_rate_lagged")->regressor(signals, std::vector{tau});
      });
    }
  }
  return out;
}

}  // namespace

std::vector<Shape> shapes_of(const Effect& effect, const Signals& signals) {
  std::vector<Shape> out = shapes_at_rest(effect, signals);
  if (!effect.info().has_history) return out;
  for (Shape& shape : out) shape = with_starts(std::move(shape), effect, signals);
  return out;
}

std::vector<Shape> shapes_of_form(const Effect& form, const Signals& signals,
                                  const std::vector<double>& further) {
  // What a further parameter may be off by, and a mixture of several: nature knows no sech^2.
  constexpr double kOff[] = {1.1, 1.6};
  std::vector<std::vector<double>> places{further};
  for (std::size_t i = 0; i < further.size(); ++i) {
    for (const double factor : kOff) {
      places.push_back(further);
      places.back()[i] *= factor;
    }
  }
  std::vector<Shape> out;
  for (const std::vector<double>& place : places) {
    const auto own = [&form, &signals, place](double inner) {
      return form.regressor(signals, parameters_of(inner, place));
    };
    out.push_back(with_starts(own, form, signals, place));
  }
  return out;
}

}  // namespace fogbench::model
