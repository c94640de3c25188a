#pragma once
// A slow quantity over one averaging window, freed of its sensor's first-order lag.
//
//   truth(t)                    = reading(t) + lag d reading/dt
//   mean truth over the window  = mean reading + lag (reading(end) - reading(start))/duration
//   mean rate over the window   = (truth(end) - truth(start))/duration
//
// Reading and slope at an end come from a short line through the readings on both sides of it. That
// holds for whatever happens within the window, but one end's slope is noisy. So the rate is
//
//   slope of the line over the window + lag (slope of its second half - of its first)/(duration/2)
//
// as long as that does not differ from the ends' by more than noise explains. It is as good as a
// parabola, and ten times less noisy in a window of 3 min; but where heating sets in halfway, the
// line's slope is up to 1.5 times the mean rate.

#include <cstddef>

#include "procedures/statistics.hpp"

namespace fogbench::procedures {

class SensorWindow {
 public:
  SensorWindow(double start_s, double end_s, double lag_s);

  /// How far from an end its line reaches: long against the noise of a few readings, short against
  /// the lag, within which nothing changes its slope.
  static double reach_s(double lag_s);

  /// Takes every reading from reach_s before the window to reach_s after it, in order; the later
  /// ones may be missing. NaN is missing.
  void add(double time_s, double reading);

  std::size_t count() const { return whole_.count(); }  ///< within the window
  // NaN when too little was read.
  double mean() const;
  double start() const { return line(start_).at(start_s_ + lag_s_); }
  double end() const { return line(end_).at(end_s_ + lag_s_); }
  double rate_per_s() const;

 private:
  double duration_s() const { return end_s_ - start_s_; }
  /// The line near one end, or the whole window's where an outage left too few readings.
  const LineFit& line(const LineFit& end) const;

  double start_s_, end_s_, lag_s_;
  LineFit whole_, first_half_, second_half_;
  LineFit start_, end_;  ///< within reach of the ends, from both sides
  SuccessiveDifferences noise_;
};

}  // namespace fogbench::procedures
