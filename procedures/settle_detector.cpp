#include "procedures/settle_detector.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "procedures/statistics.hpp"

namespace fogbench::procedures {

bool SettleDetector::add(double time_s, double temperature_c, double target_c) {
  if (readings_++ == 0) first_s_ = time_s;
  const bool hole = !dwell_.empty() && time_s - last_s_ > kLongestHoleS;
  last_s_ = time_s;
  temperature_c_ = temperature_c;
  target_c_ = target_c;
  const double deviation_c = temperature_c - target_c;
  const bool outside = std::abs(deviation_c) > criteria_.band_c;
  if ((outside || hole) && !dwell_.empty()) {
    dwell_.clear();
    ++excursions_;
  }
  settled_ = false;
  if (outside) return false;

  dwell_.push_back({time_s, temperature_c, deviation_c});
  while (dwell_.size() > 1 && dwell_[1].time_s <= time_s - criteria_.dwell_s) dwell_.pop_front();
  const bool long_enough = time_s - dwell_.front().time_s >= criteria_.dwell_s;
  settled_ = long_enough &&
             (criteria_.dwell_s <= 0.0 || std::abs(slope_c_per_h()) <= criteria_.slope_c_per_h);
  return settled_;
}

double SettleDetector::slope_c_per_h() const {
  LineFit line;
  for (const Reading& r : dwell_) line.add(r.time_s, r.temperature_c);
  return line.slope() * 3600.0;
}

std::string SettleDetector::evidence_json() const {
  Mean mean;
  double largest = 0.0;
  for (const Reading& r : dwell_) {
    mean.add(r.temperature_c);
    largest = std::max(largest, std::abs(r.deviation_c));
  }
  // NaN is written as null.
  const nlohmann::ordered_json evidence{
      {"settled", settled_},
      {"waited_s", last_s_ - first_s_},
      {"target_c", target_c_},
      {"temperature_c", temperature_c_},
      {"dwell_s", dwell_.empty() ? 0.0 : last_s_ - dwell_.front().time_s},
      {"dwell_required_s", criteria_.dwell_s},
      {"dwell_readings", dwell_.size()},
      {"dwells_broken_off", excursions_},
      {"mean_c", mean.value()},
      {"largest_deviation_c", largest},
      {"band_c", criteria_.band_c},
      {"slope_c_per_h", slope_c_per_h()},
      {"slope_limit_c_per_h", criteria_.slope_c_per_h},
  };
  return evidence.dump();
}

std::string SettleDetector::describe() const {
  if (readings_ == 0) return "the thermostat gave no reading";
  std::string text =
      fmt::format("{:.3f} degC for a target of {:.3f} degC", temperature_c_, target_c_);
  const double slope = slope_c_per_h();
  if (!std::isnan(slope)) text += fmt::format(", changing by {:.2f} degC/h", slope);
  return text;
}

}  // namespace fogbench::procedures
