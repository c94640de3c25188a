#include "model/effects/rate_of_windows.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "config/units.hpp"
#include "model/effects/history.hpp"
#include "model/table/median.hpp"

namespace fogbench::model::effects {
namespace {

using Eigen::Index;

constexpr const char* kRate = "temperature_rate_c_per_h";

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
      if (!signals.adjoin(row - 1) || !signals.adjoin(row)) continue;
      out[i] = (boundary(row, row + 1) - boundary(row - 1, row)) * config::kSecondsPerHour /
               duration[row];
    }
  }
  return out;
}

/// The table with its rates made anew.
struct Remade {
  explicit Remade(const Signals& from)
      : table(with_rates(from)), signals(table, from.reference_temperature_c()) {}

  static Table with_rates(const Signals& from) {
    Table table = from.table();
    table.set_column(kRate, rate_between_ends(from));
    return table;
  }

  const Table table;
  const Signals signals;
};

}  // namespace

std::vector<Shape> with_rate_of_windows(const Effect& own, const Signals& signals) {
  if (!signals.available("temperature_c") || !signals.available("time_s")) return {};
  return {[&own, remade = std::make_shared<const Remade>(signals)](double inner) {
    const std::vector<double> parameters(own.info().parameters.empty() ? 0 : 1, inner);
    return own.regressor(remade->signals, parameters);
  }};
}

Eigen::VectorXd lagged_rate(const Signals& signals, double tau_s) {
  return lag(signals, signals.signal(kRate), tau_s, Gap::kLinear, LagStart::kEquilibrium,
             temperature_rates_of_gaps(signals));
}

Eigen::VectorXd lagged_rate_of_means(const Signals& signals, double tau_s) {
  const Eigen::VectorXd t = signals.signal("temperature_c");
  return (t - lag(signals, t, tau_s, Gap::kLinear)) * (config::kSecondsPerHour / tau_s);
}

double usual_duration_s(const Signals& signals) {
  const auto given = signals.signal("duration_s");
  return std::max(median({given.begin(), given.end()}), 1.0);
}

}  // namespace fogbench::model::effects
