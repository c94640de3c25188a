#include "model/table/signals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "config/units.hpp"
#include "model/effects/effect.hpp"

namespace fogbench::model {
namespace {

constexpr std::array<std::string_view, 3> kFields = {"field_x_ut", "field_y_ut", "field_z_ut"};
constexpr std::array<std::string_view, 2> kCurrents = {"current_horizontal_a",
                                                       "current_vertical_a"};
/// A year: no gyro is measured that long after power-on, and 1971 is over.
constexpr double kLongestSincePowerOn_s = 3.15e7;
/// Half of the window of a derived temperature rate. Long enough that 1 mK of sensor noise stays
/// below 0.1 degC/h, short against the thermostat's ramps.
constexpr double kRateHalfWindow_s = 30.0;

/// Sums of a straight-line fit, about an origin that follows the window to keep the digits.
class SlidingLine {
 public:
  explicit SlidingLine(double origin) : origin_(origin) {}

  void add(double t, double y, double sign) {
    if (std::isnan(t) || std::isnan(y)) return;
    const double u = t - origin_;
    n_ += sign;
    u_ += sign * u;
    uu_ += sign * u * u;
    y_ += sign * y;
    uy_ += sign * u * y;
  }
  /// Per unit of t; NaN when the window holds fewer than two distinct times.
  double slope() const {
    const double spread = uu_ - u_ * u_ / n_;
    return n_ >= 2 && spread > 1e-9 * uu_ / n_ ? (uy_ - u_ * y_ / n_) / spread : kMissing;
  }

 private:
  double origin_;
  double n_ = 0, u_ = 0, uu_ = 0, y_ = 0, uy_ = 0;
};

/// Within each run: its stamps, or the time since its first row where they are a calendar's
/// (seconds since 1970), which does not tell when the power came on.
std::vector<double> since_power_on(std::vector<double> time_s,
                                   const std::vector<double>& since_start_s,
                                   const std::vector<Signals::RunRange>& runs) {
  for (const Signals::RunRange& run : runs) {
    for (std::size_t row = run.begin; row < run.end; ++row) {
      if (time_s[row] - since_start_s[row] > kLongestSincePowerOn_s)
        time_s[row] = since_start_s[row];
    }
  }
  return time_s;
}

}  // namespace

Signals::Signals(const Table& table, double reference_temperature_c)
    : table_(table),
      reference_temperature_c_(reference_temperature_c),
      end_(table.rows()),
      shared_(std::make_shared<Shared>()) {
  put_in_order();
}

void Signals::put_in_order() {
  const std::vector<std::uint32_t>& run = table_.run().index;
  // Runs in the order in which they first appear.
  std::vector<std::size_t> rank(table_.run().values.size(), table_.rows());
  std::size_t seen = 0;
  for (const std::uint32_t index : run) {
    if (rank[index] == table_.rows()) rank[index] = seen++;
  }
  // A row without a time keeps its place after the row before it.
  Values time(table_.rows(), 0.0);
  if (table_.has("time_s")) {
    const std::span<const double> given = table_.column("time_s");
    Values last(seen, -std::numeric_limits<double>::infinity());
    for (std::size_t row = 0; row < time.size(); ++row) {
      double& previous = last[rank[run[row]]];
      if (!std::isnan(given[row])) previous = given[row];
      time[row] = previous;
    }
  }
  const auto before = [&](std::size_t a, std::size_t b) {
    return std::pair(rank[run[a]], time[a]) < std::pair(rank[run[b]], time[b]);
  };
  bool ordered = true;
  for (std::size_t row = 1; row < time.size() && ordered; ++row) ordered = !before(row, row - 1);
  if (!ordered) {
    shared_->order.resize(table_.rows());
    std::iota(shared_->order.begin(), shared_->order.end(), std::size_t{0});
    std::stable_sort(shared_->order.begin(), shared_->order.end(), before);
  }
  for (std::size_t row = 0; row < time.size(); ++row) {
    const std::size_t of = run[table_row(row)];
    if (row == 0 || of != run[table_row(row - 1)]) shared_->runs.push_back({row, row});
    shared_->runs.back().end = row + 1;
  }
}

std::size_t Signals::table_row(std::size_t row) const {
  return shared_->order.empty() ? begin_ + row : shared_->order[begin_ + row];
}

Signals Signals::block(std::size_t begin, std::size_t end) const {
  Signals result = *this;
  result.begin_ = begin_ + begin;
  result.end_ = begin_ + end;
  return result;
}

bool Signals::has_numbers(std::string_view name) const {
  if (!table_.has(name)) return false;
  const std::span<const double> values = table_.column(name);
  return std::any_of(values.begin(), values.end(), [](double v) { return !std::isnan(v); });
}

bool Signals::has_both_currents() const {
  return std::all_of(kCurrents.begin(), kCurrents.end(),
                     [&](auto name) { return has_numbers(name); });
}

bool Signals::available(std::string_view name) const {
  if (has_numbers(name)) return true;
  if (name == "duration_s" || name == "run_index") return true;
  if (name == "time_since_start_s" || name == "time_since_power_on_s") return has_numbers("time_s");
  if (name == "temperature_rate_c_per_h") {
    return has_numbers("time_s") && has_numbers("temperature_c");
  }
  if (name == "temperature_acceleration_c_per_h2") {
    return has_numbers("time_s") && available("temperature_rate_c_per_h");
  }
  if (name == "temperature_gradient_rate_c_per_h") {
    return has_numbers("time_s") && has_numbers("temperature_gradient_c");
  }
  if (name == "coil_heat") {
    return has_both_currents() || has_numbers("coil_current_a") ||
           std::any_of(kFields.begin(), kFields.end(), [&](auto f) { return has_numbers(f); });
  }
  return false;
}

std::vector<std::string> Signals::missing_for(const EffectInfo& info) const {
  std::vector<std::string> missing;
  for (const std::string_view name : info.signals) {
    if (available(name)) continue;
    if (name == "coil_heat") {
      missing.emplace_back("coil_current_a");
    } else if (name == "time_since_start_s" || name == "time_since_power_on_s") {
      missing.emplace_back("time_s");
    } else if (name == "temperature_rate_c_per_h" && has_numbers("temperature_c")) {
      missing.emplace_back("time_s");  // which makes it
    } else if (name == "temperature_acceleration_c_per_h2") {
      missing.emplace_back(available("time_s") ? "temperature_rate_c_per_h" : "time_s");
    } else if (name == "temperature_gradient_rate_c_per_h") {
      missing.emplace_back(available("time_s") ? "temperature_gradient_c" : "time_s");
    } else {
      missing.emplace_back(name);
    }
  }
  return missing;
}

Signals::View Signals::signal(std::string_view name) const {
  const View all = whole(name);
  return {all.data() + begin_, static_cast<Eigen::Index>(end_ - begin_)};
}

Signals::View Signals::whole(std::string_view name) const {
  const bool given = has_numbers(name) || (table_.has(name) && !available(name));
  if (given && shared_->order.empty()) {
    const std::span<const double> values = table_.column(name);
    return {values.data(), static_cast<Eigen::Index>(values.size())};
  }
  auto found = shared_->derived.find(name);
  if (found == shared_->derived.end()) {
    Values values(table_.rows());
    if (given) {
      const std::span<const double> column = table_.column(name);
      for (std::size_t row = 0; row < values.size(); ++row) {
        values[row] = column[shared_->order[row]];
      }
    } else {
      values = derive(name);
    }
    found = shared_->derived.emplace(std::string(name), std::move(values)).first;
  }
  return {found->second.data(), static_cast<Eigen::Index>(found->second.size())};
}

Signals::Values Signals::derive(std::string_view name) const {
  if (name == "temperature_rate_c_per_h") return slope_per_hour("temperature_c", kRateHalfWindow_s);
  if (name == "temperature_acceleration_c_per_h2") {
    return has_numbers("duration_s") && has_numbers("temperature_c")
               ? acceleration_of_windows()
               : slope_per_hour("temperature_rate_c_per_h", kRateHalfWindow_s);
  }
  if (name == "temperature_gradient_rate_c_per_h") {
    return slope_per_hour("temperature_gradient_c", kRateHalfWindow_s);
  }
  if (name == "coil_heat") return coil_heat();
  if (name == "time_since_start_s") return time_since_start();
  if (name == "time_since_power_on_s") {
    const View time = whole("time_s");
    return since_power_on({time.begin(), time.end()}, time_since_start(), runs());
  }
  if (name == "run_index") return run_index();
  return Values(table_.rows(), name == "duration_s" ? 0.0 : kMissing);
}

Signals::Values Signals::slope_per_hour(std::string_view name, double half_window_s) const {
  const View time = whole("time_s");
  const View values = whole(name);
  const auto t = [&](std::size_t row) { return time[static_cast<Eigen::Index>(row)]; };
  const auto y = [&](std::size_t row) { return values[static_cast<Eigen::Index>(row)]; };
  Values rate(table_.rows(), kMissing);
  for (const RunRange& run : runs()) {
    std::size_t first = run.begin, last = run.begin;  // the window is [first, last)
    double origin = t(run.begin);
    SlidingLine line(origin);
    for (std::size_t row = run.begin; row < run.end; ++row) {
      if (std::isnan(t(row))) continue;
      std::size_t from = first, to = std::max(last, std::min(row + 2, run.end));
      while (from + 1 < row && !(t(from) >= t(row) - half_window_s)) ++from;
      while (to < run.end && !(t(to) > t(row) + half_window_s)) ++to;
      if (!(t(row) - origin <= 2.0 * half_window_s)) {
        origin = t(row);
        line = SlidingLine(origin);
        for (std::size_t i = from; i < to; ++i) line.add(t(i), y(i), 1.0);
      } else {
        for (; first < from; ++first) line.add(t(first), y(first), -1.0);
        for (; last < to; ++last) line.add(t(last), y(last), 1.0);
      }
      first = from;
      last = to;
      rate[row] = line.slope() * 3600.0;
    }
  }
  return rate;
}

bool Signals::adjoin(Eigen::Index row) const {
  constexpr double kMostGap = 0.1;  // of a window
  const View time = whole("time_s");
  const View duration = whole("duration_s");
  const double gap_s = time[row + 1] - time[row] - (duration[row] + duration[row + 1]) / 2.0;
  const double shorter = std::min(duration[row], duration[row + 1]);
  return shorter > 0.0 && std::abs(gap_s) < kMostGap * shorter;
}

Signals::Values Signals::acceleration_of_windows() const {
  const View rate = whole("temperature_rate_c_per_h");
  const View temperature = whole("temperature_c");
  const View time = whole("time_s");
  const View duration = whole("duration_s");
  const auto rate_after = [&](Eigen::Index a) {
    const double hours = (time[a + 1] - time[a]) / config::kSecondsPerHour;
    return 2.0 * (temperature[a + 1] - temperature[a]) / hours - (rate[a] + rate[a + 1]) / 2.0;
  };
  Values result = slope_per_hour("temperature_rate_c_per_h", 0.0);
  for (const RunRange& run : runs()) {
    for (std::size_t i = run.begin + 1; i + 1 < run.end; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      if (!adjoin(row - 1) || !adjoin(row)) continue;
      result[i] = (rate_after(row) - rate_after(row - 1)) * config::kSecondsPerHour / duration[row];
    }
  }
  return result;
}

Signals::Values Signals::coil_heat() const {
  Values heat(table_.rows(), 0.0);
  const auto add_squares = [&](std::string_view name, double unit) {
    const View values = whole(name);
    for (std::size_t row = 0; row < heat.size(); ++row) {
      const double value = values[static_cast<Eigen::Index>(row)] / unit;
      heat[row] += value * value;
    }
  };
  if (has_both_currents()) {
    for (const std::string_view name : kCurrents) add_squares(name, 1.0);
  } else if (has_numbers("coil_current_a")) {
    add_squares("coil_current_a", 1.0);
  } else {
    for (const std::string_view name : kFields) {
      if (has_numbers(name)) add_squares(name, kFieldUnitUt);
    }
  }
  return heat;
}

Signals::Values Signals::time_since_start() const {
  const View time = whole("time_s");
  Values since(table_.rows());
  for (const RunRange& run : runs()) {
    double start = kMissing;
    for (std::size_t row = run.begin; row < run.end; ++row) {
      const double now = time[static_cast<Eigen::Index>(row)];
      if (std::isnan(start)) start = now;
      since[row] = now - start;
    }
  }
  return since;
}

Signals::Values Signals::run_index() const {
  const TextColumn& run = table_.run();
  std::vector<std::pair<std::size_t, std::string>> names;
  for (const RunRange& range : runs()) {
    const std::string& name = run.at(table_row(range.begin));
    names.emplace_back(name.size(), name);
  }
  Values index(table_.rows());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto before = std::count_if(names.begin(), names.end(),
                                      [&](const auto& name) { return name < names[i]; });
    const RunRange& range = runs()[i];
    std::fill(index.begin() + static_cast<std::ptrdiff_t>(range.begin),
              index.begin() + static_cast<std::ptrdiff_t>(range.end), static_cast<double>(before));
  }
  return index;
}

}  // namespace fogbench::model
