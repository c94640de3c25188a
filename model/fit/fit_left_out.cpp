#include <fmt/format.h>

#include "config/units.hpp"
#include "model/fit/fit_work.hpp"
#include "model/noise/stated_errors.hpp"
#include "model/table/bad_rows.hpp"

namespace fogbench::model {
namespace {

/// "row 38 (time 6840 s, segment coil_z/up)"
std::string name_of_row(const Table& table, std::size_t row) {
  std::string where;
  const auto add = [&](const std::string& text) {
    where += where.empty() ? " (" : ", ";
    where += text;
  };
  if (table.has("time_s")) add(fmt::format("time {:g} s", table.column("time_s")[row]));
  if (!table.segment().at(row).empty()) {
    add(fmt::format("segment {}", table.segment().at(row)));
  }
  if (table.run().values.size() > 1) add(fmt::format("run {}", table.run().at(row)));
  return fmt::format("Row {}{}{}", row + 1, where, where.empty() ? "" : ")");
}

}  // namespace

Table without_readings(Table table, const std::string& observable,
                       const std::vector<LeftOut>& left_out) {
  const auto given = table.column(observable);
  std::vector<double> values(given.begin(), given.end());
  for (const LeftOut& row : left_out) values[row.row] = kMissing;
  table.set_column(observable, std::move(values));
  return table;
}

std::vector<LeftOut> find_left_out(const FitWork& work) {
  std::vector<LeftOut> out;
  const std::vector<std::size_t>& taken = work.observations.taken();
  if (taken.size() > static_cast<std::size_t>(kMostRowsToDoubt)) return out;
  Windows windows = work.observations.row_windows_or_sequence();
  if (work.observations.sigma().size() > 0) windows.white_floor = work.observations.sigma();
  windows.white_scale = stated_white_scale(windows);
  const auto shapes = NoiseShapes::make(windows, work.options.prior);
  if (!shapes) return out;
  const Linearised system =
      linearise(work, work.observations.rows(work.inner, work.inner.size() > 0));
  if (!system.x.allFinite()) return out;
  for (const BadRow& bad : find_bad_rows(windows, *shapes, system.x, system.y)) {
    const std::size_t row = work.signals.table_row(taken[static_cast<std::size_t>(bad.row)]);
    out.push_back({row, bad.off, bad.sigmas,
                   fmt::format("{} is left out: {:.3g} {} {} what the other rows say, {:.0f} "
                               "standard deviations; nothing around it shares that",
                               name_of_row(work.table, row), std::abs(bad.off),
                               config::unit_of(work.model.observable),
                               bad.off > 0.0 ? "above" : "below", bad.sigmas)});
  }
  return out;
}

}  // namespace fogbench::model
