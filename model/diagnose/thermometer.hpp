#pragma once
// What a thermometer does to a temperature: it reads in steps, and it may stick. Both are errors of
// the regressor, not of the gyro, and no effect may be named for them.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/compare/compare.hpp"
#include "model/effects/effect.hpp"
#include "model/table/signals.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// The step in which the readings come (1, 0.5, 0.1 ...), in their unit; 0 where none is seen.
double resolution_of(std::span<const double> readings);

/// The temperature that passes through the steps: where a reading changes by one step, the
/// temperature is half-way between the two; where it stays for long, the reading itself. Rows
/// without a time or a reading are as they were.
std::vector<double> through_the_steps(std::span<const double> readings,
                                      std::span<const double> time_s,
                                      const std::vector<Signals::RunRange>& runs,
                                      double resolution);

struct MendedTemperature {
  double resolution_c = 0.0;       ///< 0: none seen
  std::vector<double> readings_c;  ///< as they were; empty: nothing was mended
  std::vector<std::string> notes;
};

/// Puts temperature_c of a table in order of run and time through its steps, and a straight line
/// across a stretch in which it stuck. Nothing without time_s.
MendedTemperature mend_temperature(Table& table);

/// Acts through the temperature and its course alone.
bool acts_through_temperature(const EffectInfo& info);

/// How late a thermometer would have to read, in s, for what looks like this coefficient of the
/// temperature's rate ((deg/h)/(degC/h)) at the model's slope (deg/h/degC); nothing where no
/// thermometer is so slow.
std::optional<double> lag_that_does_the_same(double rate_coefficient, double slope);

/// What readings that are off by up to half a step make of a model's prediction.
struct StepsError {
  double resolution_c = 0.0;
  /// One a row that the fit took: deg/h/degC of the model there, and the reading.
  std::vector<double> slope, readings_c;

  /// Nothing where the prediction cannot be evaluated. `table` has a temperature_c; where it lacks
  /// kReadingsColumn, that is its own reading.
  static std::optional<StepsError> of(const Table& table, const FitResult& fit,
                                      double resolution_c);
  /// Mean over the rows, deg/h/degC.
  double mean_slope() const;
  /// RMS over the rows of what one step is worth, deg/h.
  double of_one_step() const;
  /// Whether a change of the prediction (one value a row, deg/h) may be theirs: nowhere larger than
  /// half a step at the slope of the row, and, unless it comes `of_temperature` alone, alike in
  /// rows with the same reading.
  bool explains(const Eigen::VectorXd& change, bool of_temperature) const;
  /// Adds them to the standard errors of a comparison's ranges.
  void widen(std::vector<Region>& regions) const;
};

}  // namespace fogbench::model
