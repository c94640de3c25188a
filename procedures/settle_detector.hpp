#pragma once
// Has the temperature settled? Yes when it has stayed within the band of its target for the dwell,
// and the least-squares slope over that dwell is small enough. Any excursion, and any hole in the
// readings, starts the dwell anew.

#include <deque>
#include <string>

namespace fogbench::procedures {

class SettleDetector {
 public:
  struct Criteria {
    double band_c;
    double dwell_s;
    double slope_c_per_h;
  };
  /// A longer time without a reading leaves open where the temperature has been.
  static constexpr double kLongestHoleS = 10.0;

  explicit SettleDetector(Criteria criteria) : criteria_(criteria) {}

  /// One reading; times rise. Returns settled().
  bool add(double time_s, double temperature_c, double target_c);
  bool settled() const { return settled_; }

  /// What it was decided on, as JSON.
  std::string evidence_json() const;
  /// The same for a person: "30.913 degC for a target of 31 degC, changing by 2.1 degC/h".
  std::string describe() const;

 private:
  struct Reading {
    double time_s, temperature_c, deviation_c;
  };
  double slope_c_per_h() const;

  Criteria criteria_;
  std::deque<Reading> dwell_;  ///< no longer than the dwell
  bool settled_ = false;
  double first_s_ = 0.0, last_s_ = 0.0;
  std::size_t readings_ = 0;
  std::size_t excursions_ = 0;  ///< dwells begun and broken off
  double temperature_c_ = 0.0, target_c_ = 0.0;
};

}  // namespace fogbench::procedures
