#include "procedures/sensor_window.hpp"

#include <algorithm>
#include <cmath>

namespace fogbench::procedures {
namespace {

constexpr double kLeastReachS = 5.0;
constexpr std::size_t kFewestReadings = 3;
/// Standard deviations by which two estimates of a rate must differ to show that the heating
/// changed within the window.
constexpr double kBeyondNoise = 4.0;

double square(double x) {
  return x * x;
}

}  // namespace

SensorWindow::SensorWindow(double start_s, double end_s, double lag_s)
    : start_s_(start_s), end_s_(end_s), lag_s_(lag_s) {}

double SensorWindow::reach_s(double lag_s) {
  return std::max(kLeastReachS, 0.5 * lag_s);
}

void SensorWindow::add(double time_s, double reading) {
  const double reach = reach_s(lag_s_);
  if (std::abs(time_s - start_s_) <= reach) start_.add(time_s, reading);
  if (std::abs(time_s - end_s_) <= reach) end_.add(time_s, reading);
  if (time_s < start_s_ || time_s > end_s_) return;
  whole_.add(time_s, reading);
  (2.0 * time_s < start_s_ + end_s_ ? first_half_ : second_half_).add(time_s, reading);
  noise_.add(reading);
}

double SensorWindow::mean() const {
  const double reading = count() > 1 ? whole_.at(0.5 * (start_s_ + end_s_)) : whole_.mean();
  if (lag_s_ == 0.0) return reading;
  const double change = line(end_).at(end_s_) - line(start_).at(start_s_);
  return reading + lag_s_ * change / duration_s();
}

double SensorWindow::rate_per_s() const {
  const double of_ends = (end() - start()) / duration_s();
  const double half_s = 0.5 * duration_s();
  const double of_lines =
      whole_.slope() + lag_s_ * (second_half_.slope() - first_half_.slope()) / half_s;
  const double variance =
      noise_.variance() *
      ((line(start_).spread(start_s_ + lag_s_) + line(end_).spread(end_s_ + lag_s_)) /
           square(duration_s()) +
       whole_.slope_spread() +
       square(lag_s_ / half_s) * (first_half_.slope_spread() + second_half_.slope_spread()));
  // Not so when there are too few readings for any of these.
  const bool within_noise = square(of_ends - of_lines) <= square(kBeyondNoise) * variance;
  return within_noise ? of_lines : of_ends;
}

const LineFit& SensorWindow::line(const LineFit& end) const {
  return end.count() >= kFewestReadings ? end : whole_;
}

}  // namespace fogbench::procedures
