#pragma once
// What an unknown lag of the thermometer does to a fit: a sensor that reads late makes of every
// slope of the temperature another temperature.

#include <Eigen/Core>
#include <optional>

#include "config/model_file.hpp"
#include "model/fit/observations.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// Sensors on a gyro's carrier lag by 5 to 30 s: the root of the mean square of such lags. Twice
/// that covers them all.
inline constexpr double kUsualLag_s = 19.0;

/// The table has temperatures that rise and fall, and does not say that they were freed of their
/// sensor's lag (temperature_start_c).
bool may_read_late(const Table& table, const Signals& signals);

/// By how much the model rises, in the mean of each window of the observations, when every
/// temperature is as it will be in a second, unit of the observable. Nothing where the model cannot
/// be evaluated or does not rise at all. Preconditions: may_read_late; use_windows succeeded.
std::optional<Eigen::VectorXd> rise_in_a_second(const Table& table, const Signals& signals,
                                                const config::ModelFile& fitted,
                                                const Observations& observations);

}  // namespace fogbench::model
