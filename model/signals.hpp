#pragma once
// What effects act on, taken or derived from a table: normalised field h = H/100 uT, temperature
// t = T - T_ref, time since power-on and since the run's start, temperature rate. What can be
// derived from other columns is derived (the rate from temperature and time); what cannot is named.

#include <Eigen/Core>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "config/result.hpp"
#include "model/table.hpp"

namespace fogbench::model {

struct EffectInfo;

class Signals {
 public:
  /// The table must outlive the signals.
  Signals(const Table& table, double reference_temperature_c);

  const Table& table() const { return table_; }
  std::size_t rows() const { return table_.rows(); }
  /// Rows [begin, end) of run i; rows of one run are contiguous (a table that mixes them is sorted
  /// by run first).
  struct RunRange {
    std::size_t begin, end;
  };
  const std::vector<RunRange>& runs() const { return runs_; }

  /// A column of the table, or one derived for it ("temperature_rate_c_per_h" from temperature_c
  /// and time_s). Precondition: available(name).
  Eigen::Map<const Eigen::VectorXd> signal(std::string_view name) const;
  bool available(std::string_view name) const;
  /// The columns that the effect needs and that neither stand in the table nor can be derived.
  std::vector<std::string> missing_for(const EffectInfo& info) const;
  double reference_temperature_c() const { return reference_temperature_c_; }

 private:
  const Table& table_;
  double reference_temperature_c_;
  std::vector<RunRange> runs_;
  std::map<std::string, std::vector<double>, std::less<>> derived_;
};

}  // namespace fogbench::model
