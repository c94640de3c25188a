#include "model/effects/history.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "config/units.hpp"

namespace fogbench::model::effects {
namespace {

/// x after `span_s` of an input that moves evenly from `from` to `to`.
double advanced(double x, double from, double to, double span_s, double tau_s) {
  if (span_s <= 0.0) return x;
  const double decay = std::exp(-span_s / tau_s);
  const double trail = (to - from) * tau_s / span_s;  // how far x runs behind a lasting ramp
  return to - trail + (x - from + trail) * decay;
}

}  // namespace

Eigen::VectorXd play(const Signals& signals, const Eigen::VectorXd& u, double width) {
  Eigen::VectorXd result(u.size());
  for (const Signals::RunRange& run : signals.runs()) {
    double state = 0.0;
    for (auto row = static_cast<Eigen::Index>(run.begin); row < static_cast<Eigen::Index>(run.end);
         ++row) {
      if (!std::isnan(u[row])) state = std::min(std::max(state, u[row] - width), u[row] + width);
      result[row] = std::isnan(u[row]) ? kMissing : state;
    }
  }
  return result;
}

GapMeans temperature_rates_of_gaps(const Signals& signals) {
  if (!signals.available("temperature_start_c") || !signals.available("temperature_end_c"))
    return {};
  const Signals::View start = signals.signal("temperature_start_c");
  const Signals::View end = signals.signal("temperature_end_c");
  const Signals::View time = signals.signal("time_s");
  const Signals::View duration = signals.signal("duration_s");
  GapMeans rates = GapMeans::Constant(time.size(), kMissing);
  for (const Signals::RunRange& run : signals.runs()) {
    for (auto row = static_cast<Eigen::Index>(run.begin) + 1;
         row < static_cast<Eigen::Index>(run.end); ++row) {
      const double gap_s = time[row] - time[row - 1] - (duration[row] + duration[row - 1]) / 2.0;
      if (gap_s > 0.0) rates[row] = (start[row] - end[row - 1]) / gap_s * config::kSecondsPerHour;
    }
  }
  return rates;
}

Eigen::VectorXd lag(const Signals& signals, const Eigen::VectorXd& u, double tau_s, Gap gap,
                    LagStart start, const GapMeans& gap_means) {
  const Signals::View time = signals.signal("time_s");
  const Signals::View duration = signals.signal("duration_s");
  Eigen::VectorXd result = Eigen::VectorXd::Constant(u.size(), kMissing);
  for (const Signals::RunRange& run : signals.runs()) {
    bool started = false;
    double x = 0.0, previous_u = 0.0, previous_end = 0.0;
    for (auto row = static_cast<Eigen::Index>(run.begin); row < static_cast<Eigen::Index>(run.end);
         ++row) {
      if (std::isnan(u[row]) || std::isnan(time[row])) continue;
      const double half = std::isnan(duration[row]) ? 0.0 : duration[row] / 2.0;
      double begin = time[row] - half;
      if (!started) {
        previous_u = u[row];
        x = start == LagStart::kEquilibrium ? u[row] : 0.0;
      }
      if (started) {
        begin = std::max(begin, previous_end);  // windows that overlap share their time
        const bool known = gap_means.size() > 0 && !std::isnan(gap_means[row]);
        const double from = known ? gap_means[row] : gap == Gap::kLinear ? previous_u : u[row];
        x = advanced(x, from, known ? from : u[row], begin - previous_end, tau_s);
      }
      const double end = std::max(time[row] + half, begin);
      const double x_end = advanced(x, u[row], u[row], end - begin, tau_s);
      result[row] = end > begin ? u[row] - tau_s * (x_end - x) / (end - begin) : x;
      x = x_end;
      previous_u = u[row];
      previous_end = end;
      started = true;
    }
  }
  return result;
}

}  // namespace fogbench::model::effects
