#pragma once
// Results held against acceptance limits, with the expanded uncertainty U as the guard band on
// either side of a limit (simple acceptance with a guard band, JCGM 106:2012, 8.3; ISO 14253-1):
//
//   pass            minimum <= x - U  and  x + U <= maximum
//   fail            x + U < minimum   or   x - U > maximum
//   indeterminate   anything else: within U of a limit, no uncertainty, or not measured
//
// U = k u with the limits' coverage factor k, widened as Student's t is where few degrees of
// freedom estimated u. The difference of two tests has U = hypot(U1, U2).

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/limits.hpp"
#include "config/result.hpp"

namespace fogbench::model {

enum class Conformity { kPass, kFail, kIndeterminate };

/// "pass", "fail", "indeterminate".
std::string_view name_of(Conformity verdict);

/// Where a result was measured, and so where its limit holds. NaN: not known, or without a field.
struct Conditions {
  double temperature_low_c = std::numeric_limits<double>::quiet_NaN();
  double temperature_high_c = std::numeric_limits<double>::quiet_NaN();
  std::string axes = {};  ///< of the field: "", "x", "xy"
  double field_low_ut = std::numeric_limits<double>::quiet_NaN();
  double field_high_ut = std::numeric_limits<double>::quiet_NaN();
};

/// One result of one test.
struct Measured {
  std::string quantity, test, unit;
  double value;           ///< NaN: not determined
  double standard_error;  ///< NaN: not known
  /// t of 95.45 % for the degrees of freedom behind the standard error; 2 for many.
  double coverage_factor = 2.0;
  Conditions conditions = {};
};

/// One result against its limits.
struct Judgement {
  std::string quantity;
  std::string test;  ///< empty: held by fewer tests than expected
  std::string unit;
  double value, expanded_uncertainty;  ///< NaN when not measured
  std::optional<double> minimum, maximum;
  Conformity verdict = Conformity::kIndeterminate;
  int tests_measured = 0;  ///< how many tests hold the quantity
  int tests_expected = 1;
  Conditions conditions = {};
};

/// One result in one test and in the next that holds it.
struct Repeat {
  std::string quantity, unit, test_a, test_b;
  double value_a, value_b;
  double difference, expanded_uncertainty;  ///< b - a
  bool significant = false;                 ///< the difference is larger than its uncertainty
  std::optional<double> limit;
  std::optional<Conformity> verdict;  ///< without a limit nothing is judged
};

struct Judged {
  Conformity overall = Conformity::kIndeterminate;
  double coverage_factor = 2.0;
  std::vector<Judgement> results;
  std::vector<Repeat> repeats;  ///< of limited quantities first, then of all others
};

/// U of one result.
double expanded_uncertainty(const Measured& measured, double coverage_factor);

/// The rule above. NaN is indeterminate.
Conformity judge(double value, double expanded_uncertainty, std::optional<double> minimum,
                 std::optional<double> maximum);

/// A fail anywhere is a fail; then anything indeterminate is indeterminate.
Conformity worst_of(Conformity a, Conformity b);

/// kBadInput when a limit's unit is not the one that the result has.
Result<Judged> judge_results(const std::vector<Measured>& measured,
                             const config::LimitsConfig& limits);

}  // namespace fogbench::model
