#include "model/next/bench_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace fogbench::model {
namespace {

using Eigen::Index;

// Coil, carrier and heaters of a gyro in an aluminium case: some 0.8 kg of mostly aluminium.
constexpr double kHeatCapacity_j_per_k = 830.0;
// Through the foam. The 9 W of the normal heater must hold 34 degC above the room: at most 0.265.
constexpr double kLoss_w_per_k = 0.22;
// The heating element before the carrier feels it: 30 J/K behind a link of 2 W/K.
constexpr double kElement_s = 15.0;
constexpr double kBoostMaximum_w = 12.0;  // 6 W + 3 W + 3 W
constexpr double kNormalMaximum_w = 9.0;
// A proportional band of about 1 degC, as thermostats are usually set.
constexpr double kGain_w_per_k = 10.0;
// Between the two working sensors. The boost heaters sit nearer to one of them; the normal heater
// is spread over the carrier and leaves a fifth of that. Only the inequality matters here.
constexpr double kGradientOfBoost_c_per_w = 0.05;
constexpr double kGradientOfNormal_c_per_w = 0.01;
// A room with air conditioning wanders by a few tenths over a couple of hours.
constexpr double kAmbientWander_c = 0.3;
constexpr double kAmbientPeriod_s = 7200.0;
constexpr double kTurn_s = 60.0;          // by hand, with a prompt
constexpr double kFieldSettle_s = 5.0;    // the sweep's settling time before each average
constexpr double kCoils_ut_per_a = 89.9;  // 50 turns at 0.5 m
constexpr double kBand_c = 0.1;           // settled: this near to the set point ...
constexpr double kDwell_s = 300.0;        // ... for so long
constexpr double kMostSettling_s = 7200.0;
constexpr double kStep_s = 5.0;  // short against the thermostat's time constant, C / gain = 83 s

int place_of(char axis) {
  return axis - 'x';
}

}  // namespace

BenchSchedule::BenchSchedule(double ambient_c) : mean_ambient_c_(ambient_c) {
  state_.temperature_c = state_.ambient_c = ambient_c;
}

void BenchSchedule::heat(Heater heater, double set_c) {
  heater_ = heater;
  set_c_ = set_c;
}

void BenchSchedule::field(char axis, double field_ut) {
  field_ut_[place_of(axis)] = field_ut;
}

void BenchSchedule::turn(double azimuth_deg) {
  std::fill(std::begin(field_ut_), std::end(field_ut_), 0.0);
  wait(kTurn_s);
  azimuth_deg_ = azimuth_deg;
}

void BenchSchedule::advance(double step_s) {
  const double phase = 2.0 * std::numbers::pi * state_.time_s / kAmbientPeriod_s;
  state_.ambient_c = mean_ambient_c_ + kAmbientWander_c * std::sin(phase);
  const double most = heater_ == Heater::kBoost    ? kBoostMaximum_w
                      : heater_ == Heater::kNormal ? kNormalMaximum_w
                                                   : 0.0;
  const double wanted =
      kLoss_w_per_k * (set_c_ - state_.ambient_c) + kGain_w_per_k * (set_c_ - state_.temperature_c);
  state_.heater_w = std::clamp(wanted, 0.0, most);
  const double share = 1.0 - std::exp(-step_s / kElement_s);
  arriving_w_ += share * (state_.heater_w - arriving_w_);
  arriving_boost_w_ +=
      share * ((heater_ == Heater::kBoost ? state_.heater_w : 0.0) - arriving_boost_w_);
  const double lost = kLoss_w_per_k * (state_.temperature_c - state_.ambient_c);
  const double rate_c_per_s = (arriving_w_ - lost) / kHeatCapacity_j_per_k;
  state_.rate_c_per_h = 3600.0 * rate_c_per_s;
  state_.temperature_c += rate_c_per_s * step_s;
  state_.gradient_c = kGradientOfBoost_c_per_w * arriving_boost_w_ +
                      kGradientOfNormal_c_per_w * (arriving_w_ - arriving_boost_w_);
  state_.time_s += step_s;
}

void BenchSchedule::wait(double seconds) {
  for (double left = seconds; left > 1e-6; left -= kStep_s) advance(std::min(left, kStep_s));
}

void BenchSchedule::record(double seconds, double window_s, const std::string& segment) {
  for (double done = 0.0; done + window_s < seconds + 1e-6; done += window_s) {
    Row row{.centre_s = state_.time_s + 0.5 * window_s,
            .duration_s = window_s,
            .mean = {},
            .field_ut = {field_ut_[0], field_ut_[1], field_ut_[2]},
            .azimuth_deg = azimuth_deg_,
            .segment = segment};
    for (double left = window_s; left > 1e-6; left -= kStep_s) {
      const double step = std::min(left, kStep_s), share = step / window_s;
      advance(step);
      row.mean.temperature_c += share * state_.temperature_c;
      row.mean.rate_c_per_h += share * state_.rate_c_per_h;
      row.mean.gradient_c += share * state_.gradient_c;
      row.mean.heater_w += share * state_.heater_w;
      row.mean.ambient_c += share * state_.ambient_c;
    }
    rows_.push_back(std::move(row));
  }
}

bool BenchSchedule::at_rest() const {
  return std::abs(state_.temperature_c - set_c_) < kBand_c;
}

void BenchSchedule::settle(double window_s, const std::string& segment) {
  const double step = window_s > 0.0 ? window_s : kStep_s;
  double inside = 0.0;
  for (double spent = 0.0; spent < kMostSettling_s && inside < kDwell_s; spent += step) {
    window_s > 0.0 ? record(window_s, window_s, segment) : wait(kStep_s);
    inside = at_rest() ? inside + step : 0.0;
  }
}

void BenchSchedule::cool_to(double temperature_c, double window_s, const std::string& segment) {
  heat(Heater::kOff);
  for (double spent = 0.0; spent < 2.0 * kMostSettling_s && state_.temperature_c > temperature_c;
       spent += window_s) {
    record(window_s, window_s, segment);
  }
}

void BenchSchedule::sweep(char axis, const std::vector<double>& levels_ut, double window_s,
                          int windows) {
  for (std::size_t i = 0; i < levels_ut.size(); ++i) {
    const bool down = i > 0 && levels_ut[i] < levels_ut[i - 1];
    field(axis, levels_ut[i]);
    wait(kFieldSettle_s);
    record(window_s * windows, window_s, std::string("coil_") + axis + (down ? "/down" : "/up"));
  }
}

Recorded BenchSchedule::recorded() const {
  Recorded out;
  const auto column = [&](const char* name, auto value) {
    std::vector<double> values;
    for (const Row& row : rows_) values.push_back(value(row));
    out.table.set_column(name, std::move(values));
  };
  column("time_s", [](const Row& r) { return r.centre_s; });
  column("duration_s", [](const Row& r) { return r.duration_s; });
  column("temperature_c", [](const Row& r) { return r.mean.temperature_c; });
  column("temperature_rate_c_per_h", [](const Row& r) { return r.mean.rate_c_per_h; });
  column("temperature_gradient_c", [](const Row& r) { return r.mean.gradient_c; });
  column("heater_w", [](const Row& r) { return r.mean.heater_w; });
  column("ambient_c", [](const Row& r) { return r.mean.ambient_c; });
  column("field_x_ut", [](const Row& r) { return r.field_ut[0]; });
  column("field_y_ut", [](const Row& r) { return r.field_ut[1]; });
  column("field_z_ut", [](const Row& r) { return r.field_ut[2]; });
  column("coil_current_a", [](const Row& r) {
    return (r.field_ut[0] + r.field_ut[1] + r.field_ut[2]) / kCoils_ut_per_a;
  });
  column("current_horizontal_a", [](const Row& r) { return r.field_ut[0] / kCoils_ut_per_a; });
  column("current_vertical_a",
         [](const Row& r) { return std::hypot(r.field_ut[1], r.field_ut[2]) / kCoils_ut_per_a; });
  column("azimuth_deg", [](const Row& r) { return r.azimuth_deg; });

  TextColumn segment;
  std::map<std::string, std::uint32_t> known;
  for (const Row& row : rows_) {
    const auto next = static_cast<std::uint32_t>(segment.values.size());
    const auto [found, fresh] = known.try_emplace(row.segment, next);
    if (fresh) segment.values.push_back(row.segment);
    segment.index.push_back(found->second);
  }
  out.table.set_segment(std::move(segment));

  const auto n = static_cast<Index>(rows_.size());
  const auto vector = [&](const char* name) {
    return Eigen::VectorXd(Eigen::VectorXd::Map(out.table.column(name).data(), n));
  };
  out.windows = {.run_begin = {0, rows_.size()},
                 .centre_s = vector("time_s"),
                 .duration_s = vector("duration_s"),
                 .white_floor = Eigen::VectorXd::Zero(n)};
  out.hours = state_.time_s / 3600.0;
  return out;
}

}  // namespace fogbench::model
