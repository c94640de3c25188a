#include "model/effects/history.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "config/units.hpp"
#include "model/table/median.hpp"

namespace fogbench::model::effects {
namespace {

/// x after `span_s` of an input that moves evenly from `from` to `to`.
double advanced(double x, double from, double to, double span_s, double tau_s) {
  if (span_s <= 0.0) return x;
  const double decay = std::exp(-span_s / tau_s);
  const double trail = (to - from) * tau_s / span_s;  // how far x runs behind a lasting ramp
  return to - trail + (x - from + trail) * decay;
}

/// More gaps than this are no accident.
constexpr std::size_t kMostGaps = 3;
/// Rows are missing where this share of the usual step is beyond the usual gap, and 10 s at least:
/// in less no field and no temperature goes anywhere and comes back.
constexpr double kMissingStep = 0.75;
constexpr double kLeastGap_s = 10.0;
/// Where in its band a play may begin, in half-widths from the middle. Between them the play is
/// nearly a mean of its neighbours.
constexpr std::array<double, 2> kBeginnings = {-1.0, 1.0};

/// Elementary loops of a relaxing one, in widths, up to where exp(-width) no longer counts.
constexpr int kLoops = 12;
constexpr double kWidestLoop = 4.0;

/// First rows after a gap that is longer than usual; none where that is not known.
std::vector<std::size_t> rows_after_gaps(const Signals& signals) {
  if (!signals.available("time_s")) return {};
  const Signals::View time = signals.signal("time_s");
  const Signals::View duration = signals.signal("duration_s");
  std::vector<double> gaps, steps;
  std::vector<std::size_t> rows;
  for (const Signals::RunRange& run : signals.runs()) {
    for (std::size_t i = run.begin + 1; i < run.end; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const double step = time[row] - time[row - 1];
      const double gap = step - (duration[row] + duration[row - 1]) / 2.0;
      if (!std::isfinite(gap)) continue;
      steps.push_back(step);
      gaps.push_back(gap);
      rows.push_back(i);
    }
  }
  if (rows.empty()) return {};
  const double most = median(gaps) + std::max(kMissingStep * median(steps), kLeastGap_s);
  std::vector<std::size_t> after;
  for (std::size_t i = 0; i < rows.size() && after.size() <= kMostGaps; ++i) {
    if (gaps[i] > most) after.push_back(rows[i]);
  }
  return after.size() <= kMostGaps ? after : std::vector<std::size_t>{};
}

}  // namespace

std::vector<Signals::RunRange> stretches(const Signals& signals) {
  const std::vector<std::size_t> cuts = rows_after_gaps(signals);
  std::vector<Signals::RunRange> out;
  for (const Signals::RunRange& run : signals.runs()) {
    out.push_back(run);
    for (const std::size_t cut : cuts) {
      if (cut <= run.begin || cut >= run.end) continue;
      out.back().end = cut;
      out.push_back({cut, run.end});
    }
  }
  return out;
}

Eigen::MatrixXd play_starts(const Signals& signals, const Eigen::VectorXd& u, double width) {
  const std::vector<Signals::RunRange> parts = stretches(signals);
  const auto places = static_cast<Eigen::Index>(kBeginnings.size());
  const Eigen::VectorXd assumed = play(signals, u, width);
  Eigen::MatrixXd starts =
      Eigen::MatrixXd::Zero(u.size(), places * static_cast<Eigen::Index>(parts.size()));
  for (std::size_t part = 0; part < parts.size(); ++part) {
    for (Eigen::Index place = 0; place < places; ++place) {
      auto column = starts.col(places * static_cast<Eigen::Index>(part) + place);
      double state = kMissing;
      for (std::size_t i = parts[part].begin; i < parts[part].end; ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        if (std::isnan(u[row])) continue;
        if (std::isnan(state))
          state = u[row] + kBeginnings[static_cast<std::size_t>(place)] * width;
        state = std::min(std::max(state, u[row] - width), u[row] + width);
        column[row] = state - assumed[row];
      }
    }
  }
  return starts;
}

Eigen::MatrixXd lag_starts(const Signals& signals, const Eigen::VectorXd& u, double tau_s) {
  const Signals::View time = signals.signal("time_s");
  const Signals::View duration = signals.signal("duration_s");
  const std::vector<Signals::RunRange> parts = stretches(signals);
  const auto known = u.array().isFinite();
  const double least = known.select(u.array(), std::numeric_limits<double>::infinity()).minCoeff();
  const double most = known.select(u.array(), -std::numeric_limits<double>::infinity()).maxCoeff();
  Eigen::MatrixXd starts = Eigen::MatrixXd::Zero(u.size(), static_cast<Eigen::Index>(parts.size()));
  if (!(most > least)) return starts;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    double begin = kMissing;
    for (std::size_t i = parts[part].begin; i < parts[part].end; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      if (std::isnan(u[row]) || std::isnan(time[row])) continue;
      const double half = std::isnan(duration[row]) ? 0.0 : duration[row] / 2.0;
      if (std::isnan(begin)) begin = time[row] - half;
      // The mean of an exponential over the window.
      const double from = (time[row] - half - begin) / tau_s, length = 2.0 * half / tau_s;
      const double mean = length > 0.0 ? -std::expm1(-length) / length : 1.0;
      starts(row, static_cast<Eigen::Index>(part)) =
          (most - least) * std::exp(-std::max(from, 0.0)) * mean;
    }
  }
  return starts;
}

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

Eigen::VectorXd relaxing_loop(const Signals& signals, const Eigen::VectorXd& u, double width) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(u.size());
  double weights = 0.0;
  for (int k = 0; k < kLoops; ++k) {
    const double relative = (k + 0.5) * kWidestLoop / kLoops;
    const double weight = std::exp(-relative);
    weights += weight;
    for (const Signals::RunRange& run : signals.runs()) {
      double state = u[static_cast<Eigen::Index>(run.begin)];
      for (std::size_t i = run.begin; i < run.end; ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        state = std::min(std::max(state, u[row] - relative * width), u[row] + relative * width);
        out[row] += weight * state;
      }
    }
  }
  return out / weights;
}

Eigen::VectorXd path_lag(const Signals& signals, const Eigen::VectorXd& u, double width) {
  Eigen::VectorXd out(u.size());
  for (const Signals::RunRange& run : signals.runs()) {
    double m = u[static_cast<Eigen::Index>(run.begin)], before = m;
    for (std::size_t i = run.begin; i < run.end; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
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

}  // namespace fogbench::model::effects
