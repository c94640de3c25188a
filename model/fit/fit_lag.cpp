#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <cmath>
#include <optional>

#include "config/units.hpp"
#include "model/fit/fit_work.hpp"

namespace fogbench::model {
namespace {

// Sensors on a gyro's carrier lag by 5 to 30 s: the root of the mean square of such lags. Twice
// that covers them all.
constexpr double kUsualLag_s = 19.0;
// Uncertainties that grow by less than this share are not worth a word.
constexpr double kWorthSaying = 0.1;

/// By how much the model rises, row by row of the table, when every temperature is as it will be in
/// a second; nothing where it cannot be evaluated.
std::optional<Eigen::VectorXd> rise_in_a_second(const FitWork& work) {
  FitWork now = work;
  now.result.warnings.clear();
  fill_residuals(now);
  fill_estimates(now);
  const config::ModelFile fitted = fitted_model(now);
  const Signals::View rate = work.signals.signal("temperature_rate_c_per_h");
  const auto given = work.table.column("temperature_c");
  std::vector<double> later(given.begin(), given.end());
  for (std::size_t i = 0; i < work.signals.rows(); ++i) {
    later[work.signals.table_row(i)] +=
        rate[static_cast<Eigen::Index>(i)] / config::kSecondsPerHour;
  }
  Table table = work.table;
  const auto before = predict(table, fitted);
  table.set_column("temperature_c", std::move(later));
  const auto after = predict(table, fitted);
  if (!before || !after) return std::nullopt;
  return *after - *before;
}

}  // namespace

void allow_for_lag(FitWork& work) {
  if (!work.table.has("temperature_c") || work.table.has("temperature_start_c") ||
      !work.signals.available("temperature_rate_c_per_h")) {
    return;
  }
  const auto rise = rise_in_a_second(work);
  const auto whitener = make_whitener(work.observations.windows(), work.result.noise.noise);
  if (!rise || !whitener) return;
  const Eigen::MatrixXd x =
      linearise(work, work.observations.window_rows(work.inner, work.inner.size() > 0)).x;
  const std::vector<Eigen::Index>& window_of = work.observations.bin_of();
  Eigen::VectorXd of_windows = Eigen::VectorXd::Zero(x.rows()), members = of_windows;
  for (std::size_t i = 0; i < window_of.size(); ++i) {
    const std::size_t row = work.signals.table_row(work.observations.taken()[i]);
    const double value = (*rise)[static_cast<Eigen::Index>(row)];
    if (std::isfinite(value)) of_windows[window_of[i]] += value;
    members[window_of[i]] += 1.0;
  }
  of_windows = of_windows.cwiseQuotient(members.cwiseMax(1.0));
  if (of_windows.isZero(0.0)) return;

  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    if (std::isfinite(work.covariance(i, i))) known.push_back(i);
  }
  const Eigen::VectorXd moved = kUsualLag_s * (*whitener)
                                                  ->whiten(x(Eigen::all, known))
                                                  .colPivHouseholderQr()
                                                  .solve((*whitener)->whiten(of_windows).col(0));
  std::vector<std::string> wider;
  const std::vector<Eigen::Index> free = work.design.free_columns();
  for (std::size_t k = 0; k < known.size(); ++k) {
    const double before = work.covariance(known[k], known[k]);
    const double added = moved[static_cast<Eigen::Index>(k)] * moved[static_cast<Eigen::Index>(k)];
    if (known[k] >= work.free() || std::sqrt(1.0 + added / before) < 1.0 + kWorthSaying) continue;
    const DesignColumn& column =
        work.design.columns()[static_cast<std::size_t>(free[static_cast<std::size_t>(known[k])])];
    if (!column.start) wider.push_back(column.name);
  }
  work.covariance(known, known) += moved * moved.transpose();
  if (wider.empty()) return;
  work.result.warnings.push_back(
      fmt::format("the table does not say that its temperatures are freed of "
                  "their sensor's lag "
                  "(temperature_start_c): a usual lag of {:.0f} s is part of "
                  "the uncertainty of {}",
                  kUsualLag_s, fmt::join(wider, ", ")));
}

}  // namespace fogbench::model
