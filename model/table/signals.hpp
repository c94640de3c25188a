#pragma once
// What effects act on: a table's columns in the order in which things happened (run by run, by
// time_s within a run), and what can be derived from them. What can be neither found nor derived is
// named.
//
// Derived when the table lacks it:
//   temperature_rate_c_per_h  slope of temperature_c over the rows within 30 s (at least the
//                             neighbouring rows), least squares
//   temperature_acceleration_c_per_h2  the same slope of the temperature rate; of averages, which
//   are
//                             smooth already, over the neighbouring rows only
//   temperature_gradient_rate_c_per_h  slope of temperature_gradient_c, as the temperature's
//   duration_s                0: a row is then a sample, not an average
//   coil_heat                 sum of the squared currents of both coil pairs, A^2; where these are
//                             not both given, of coil_current_a; where that is not given either, of
//                             the fields, (100 uT)^2, which miss what nulls the ambient field
//   time_since_start_s        time_s minus that of the run's first row
//   run_index                 0 for the first run by name ("2" before "10"), 1 for the next

#include <Eigen/Core>
#include <array>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "config/result.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// Fields enter every effect in units of 100 uT.
inline constexpr double kFieldUnitUt = 100.0;

/// The measured field along each axis of the gyro.
struct FieldSignal {
  std::string_view name;
  char axis;
};
inline constexpr std::array<FieldSignal, 3> kFieldSignals = {
    {{"field_x_ut", 'x'}, {"field_y_ut", 'y'}, {"field_z_ut", 'z'}}};

struct EffectInfo;

/// Cheap to copy. Not thread-safe: signals are derived when first asked for.
class Signals {
 public:
  using View = Eigen::Map<const Eigen::VectorXd>;
  /// Rows [begin, end) of one run.
  struct RunRange {
    std::size_t begin, end;
  };

  /// The table must outlive the signals.
  Signals(const Table& table, double reference_temperature_c);

  const Table& table() const { return table_; }
  std::size_t rows() const { return end_ - begin_; }
  double reference_temperature_c() const { return reference_temperature_c_; }
  /// The runs, contiguous, in the order of their first row in the table.
  const std::vector<RunRange>& runs() const { return shared_->runs; }
  /// The table's row that stands at `row` here.
  std::size_t table_row(std::size_t row) const;
  /// Rows [begin, end) of these signals, for effects that need no history.
  Signals block(std::size_t begin, std::size_t end) const;

  /// The windows of `row` and of the next one follow each other without a gap; rows as runs()
  /// counts them. Precondition: time_s and duration_s are available.
  bool adjoin(Eigen::Index row) const;

  /// A column of the table, or one derived for it. Precondition: available(name).
  View signal(std::string_view name) const;
  /// In the table with at least one number, or derivable.
  bool available(std::string_view name) const;
  /// The columns that the effect needs and that neither stand in the table nor can be derived.
  std::vector<std::string> missing_for(const EffectInfo& info) const;

 private:
  using Values = std::vector<double>;
  struct Shared {
    std::vector<RunRange> runs;
    std::vector<std::size_t> order;  ///< empty: as in the table
    std::map<std::string, Values, std::less<>> derived;
  };

  void put_in_order();
  Values derive(std::string_view name) const;
  /// Least squares over the rows near each row, NaN where there are too few.
  Values slope_per_hour(std::string_view name, double half_window_s) const;
  bool has_both_currents() const;
  /// Of averages: the rate at each end of a window is 2 x the slope between the two windows' means
  /// less the mean of their own rates, exact for a cubic. Beside gaps, the slope of the rate.
  Values acceleration_of_windows() const;
  Values coil_heat() const;
  Values time_since_start() const;
  Values run_index() const;
  bool has_numbers(std::string_view name) const;
  View whole(std::string_view name) const;

  const Table& table_;
  double reference_temperature_c_;
  std::size_t begin_ = 0, end_ = 0;
  std::shared_ptr<Shared> shared_;
};

}  // namespace fogbench::model
