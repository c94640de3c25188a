#include "model/fit/fit_lag.hpp"

#include <cmath>

#include "config/units.hpp"
#include "model/fit/predict.hpp"

namespace fogbench::model {

bool may_read_late(const Table& table, const Signals& signals) {
  return table.has("temperature_c") && !table.has("temperature_start_c") &&
         signals.available("temperature_rate_c_per_h");
}

std::optional<Eigen::VectorXd> rise_in_a_second(const Table& table, const Signals& signals,
                                                const config::ModelFile& fitted,
                                                const Observations& observations) {
  const Signals::View rate = signals.signal("temperature_rate_c_per_h");
  const auto given = table.column("temperature_c");
  std::vector<double> later(given.begin(), given.end());
  for (std::size_t i = 0; i < signals.rows(); ++i) {
    later[signals.table_row(i)] += rate[static_cast<Eigen::Index>(i)] / config::kSecondsPerHour;
  }
  Table in_a_second = table;
  in_a_second.set_column("temperature_c", std::move(later));
  const auto before = predict(table, fitted), after = predict(in_a_second, fitted);
  if (!before || !after) return std::nullopt;
  const Eigen::VectorXd rise = *after - *before;

  const std::vector<Eigen::Index>& window_of = observations.bin_of();
  Eigen::VectorXd of_windows = Eigen::VectorXd::Zero(observations.windows().rows());
  Eigen::VectorXd members = of_windows;
  for (std::size_t i = 0; i < window_of.size(); ++i) {
    const std::size_t row = signals.table_row(observations.taken()[i]);
    const double value = rise[static_cast<Eigen::Index>(row)];
    if (std::isfinite(value)) of_windows[window_of[i]] += value;
    members[window_of[i]] += 1.0;
  }
  of_windows = of_windows.cwiseQuotient(members.cwiseMax(1.0));
  if (of_windows.isZero(0.0)) return std::nullopt;
  return of_windows;
}

}  // namespace fogbench::model
