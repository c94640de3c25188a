#pragma once
// States that effects carry through a run: the play operator and the first-order lag.

#include <Eigen/Core>
#include <vector>

#include "model/table/signals.hpp"

namespace fogbench::model::effects {

/// Stretches of rows of which the past is unknown: each run's, cut where rows are missing in the
/// middle of it (a voided point, an interruption): what was between them may have been anything.
/// Where more than a few are missing the rows are sparse by intent, and only the runs count.
std::vector<Signals::RunRange> stretches(const Signals& signals);

/// The play (backlash) operator of half-width `width`: p follows u at the distance width,
///   p_i = min(max(p_(i-1), u_i - width), u_i + width),
/// from p = 0 (virgin: reference temperature, no field) before each run's first row. Rows where u
/// is missing leave the state alone and are NaN.
Eigen::VectorXd play(const Signals& signals, const Eigen::VectorXd& u, double width);
/// What the play differs by when it begins each stretch elsewhere in its band: at both ends and at
/// two places between them. Zero from the first full traverse on.
Eigen::MatrixXd play_starts(const Signals& signals, const Eigen::VectorXd& u, double width);

/// A loop that relaxes exponentially with the way that u has gone since its reversal: a sum of play
/// operators with exponentially distributed widths (Prandtl-Ishlinskii). It starts where u starts.
Eigen::VectorXd relaxing_loop(const Signals& signals, const Eigen::VectorXd& u, double width);
/// A magnetisation that relaxes towards the field with the way that the field has gone:
/// dm = (u - m) |du| / width. In a steady sweep it cannot be told from a lag in time.
Eigen::VectorXd path_lag(const Signals& signals, const Eigen::VectorXd& u, double width);

/// What u does in the gap between one averaging window's end and the next one's beginning.
enum class Gap {
  kLinear,   ///< moves evenly from the one mean to the next (temperatures)
  kStepped,  ///< takes the next value at once (fields: the supply is fast)
};

/// What x is when a run's first window begins.
enum class LagStart {
  kEquilibrium,  ///< u has been the same long before
  kZero,
};

/// In the gap before each row, what u is there on average; NaN where that is not known.
using GapMeans = Eigen::VectorXd;

/// The temperature rate in the gaps between windows, degC/h, from the temperatures at the ends of
/// the windows beside them (temperature_start_c, temperature_end_c). Empty where the table has
/// none.
GapMeans temperature_rates_of_gaps(const Signals& signals);

/// The first-order lag tau x' = u - x. u holds window means and is
/// constant within a window. The result is x averaged over each window, exactly
/// (a gap whose mean is known is bridged with it):
///   mean(x) = u - tau (x_end - x_begin) / duration,
/// and x itself where the duration is 0. Rows where u or the time is missing are bridged and NaN.
Eigen::VectorXd lag(const Signals& signals, const Eigen::VectorXd& u, double tau_s, Gap gap,
                    LagStart start = LagStart::kEquilibrium, const GapMeans& gap_means = {});
/// What the lag of u differs by when it does not begin each stretch as assumed: the range of u,
/// dying away with tau, averaged over each window.
Eigen::MatrixXd lag_starts(const Signals& signals, const Eigen::VectorXd& u, double tau_s);

}  // namespace fogbench::model::effects
