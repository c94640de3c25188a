#include "model/diagnose/working_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "config/channels.hpp"
#include "model/diagnose/thermometer.hpp"
#include "model/fit/design.hpp"
#include "model/noise/stated_errors.hpp"
#include "model/table/condense.hpp"
#include "model/table/median.hpp"
#include "model/table/row_order.hpp"
#include "model/table/signals.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr std::size_t kMostFineRows = 30'000;
constexpr std::size_t kMostRows = 800;
// A column with fewer numbers than this share cannot be filled from its neighbours.
constexpr double kLeastFilled = 0.5;
constexpr const char* kStdError = "rate_std_error_deg_per_h";

using Bin = RowGroup;

TextColumn picked(const TextColumn& from, const std::vector<std::size_t>& rows) {
  TextColumn to{from.values, {}};
  to.index.reserve(rows.size());
  for (const std::size_t row : rows) to.index.push_back(from.index[row]);
  return to;
}

std::vector<double> picked(std::span<const double> values, const std::vector<std::size_t>& rows) {
  std::vector<double> out;
  out.reserve(rows.size());
  for (const std::size_t row : rows) out.push_back(values[row]);
  return out;
}

/// Squares and products of larger numbers overflow; a length or a scatter is not negative.
Status check_numbers(const Table& table) {
  constexpr double kLargest = 1e60;
  for (const std::string& name : table.column_names()) {
    const double least = name == "duration_s" || name == kStdError ? 0.0 : -kLargest;
    const auto values = table.column(name);
    const auto wrong = std::find_if(values.begin(), values.end(),
                                    [&](double v) { return v < least || v > kLargest; });
    if (wrong == values.end()) continue;
    return Error{ErrorCode::kBadInput,
                 fmt::format("column {}, row {}: found {:g}, expected {:g} to {:g}", name,
                             wrong - values.begin() + 1, *wrong, least, kLargest)};
  }
  return {};
}

/// Of each row, whether the model can be evaluated and compared with a measurement there.
Result<std::vector<bool>> complete_rows(const Table& table, const config::ModelFile& model) {
  if (!table.has(model.observable)) {
    return Error{ErrorCode::kBadInput, table.why_missing(model.observable)};
  }
  const Signals signals(table, model.reference_temperature_c);
  const auto design = Design::make(signals, model, false);
  if (!design) return design.error();
  std::vector<std::span<const double>> needed{table.column(model.observable)};
  for (const std::string& name : design->signals_needed()) {
    if (table.has(name)) needed.push_back(table.column(name));
  }
  std::vector<bool> rows(table.rows());
  for (std::size_t row = 0; row < table.rows(); ++row) {
    rows[row] = std::all_of(needed.begin(), needed.end(),
                            [&](const auto& column) { return std::isfinite(column[row]); });
  }
  if (std::find(rows.begin(), rows.end(), true) == rows.end()) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("found no row with {} and every signal of the model, expected some",
                             model.observable)};
  }
  return rows;
}

/// Fills gaps with the number before (or, at the start, after) them. An error says that the column
/// is mostly gaps.
Status fill_gaps(const std::string& name, std::vector<double>& column) {
  const auto number = [](double v) { return std::isfinite(v); };
  const auto filled = std::count_if(column.begin(), column.end(), number);
  if (filled == std::ssize(column)) return {};
  if (static_cast<double>(filled) < kLeastFilled * static_cast<double>(column.size())) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("column {}: has a number in {} of {} rows, expected more", name,
                             filled, column.size())};
  }
  double last = *std::find_if(column.begin(), column.end(), number);
  for (double& v : column) {
    if (std::isfinite(v)) last = v;
    v = last;
  }
  return {};
}

/// Centre and duration of every row, windows of a run never overlapping.
struct RowTimes {
  std::vector<double> centre, duration;
  bool usable = true;  ///< false: the time does not advance, the rows follow each other
};

/// Empty `time` or `duration`: the table has none, or none that advances.
RowTimes times_of(const TextColumn& runs, std::vector<double> time, std::vector<double> duration) {
  const auto& run = runs.index;
  const std::size_t n = run.size();
  RowTimes out{std::move(time), std::move(duration), true};
  out.usable = out.centre.size() == n;
  std::vector<double> steps;
  for (std::size_t i = 1; i < n && out.usable; ++i) {
    if (run[i] != run[i - 1]) continue;
    steps.push_back(out.centre[i] - out.centre[i - 1]);
    out.usable = steps.back() > 0.0;
  }
  if (!out.usable) {
    out.centre.resize(n);
    std::iota(out.centre.begin(), out.centre.end(), 0.0);
    out.duration.assign(n, kUntimedWindow_s);
    for (double& centre : out.centre) centre *= kUntimedWindow_s;
    return out;
  }
  const double usual = steps.empty() ? kUntimedWindow_s : median(std::move(steps));
  out.duration.resize(n, 0.0);
  for (double& d : out.duration) d = d > 0.0 ? d : usual;
  for (std::size_t i = 1; i < n; ++i) {
    if (run[i] != run[i - 1]) continue;
    const double gap = out.centre[i] - out.centre[i - 1];
    if (0.5 * (out.duration[i] + out.duration[i - 1]) <= gap) continue;
    out.duration[i] = std::min(out.duration[i], gap);
    out.duration[i - 1] = std::min(out.duration[i - 1], gap);
  }
  return out;
}

/// Neighbouring rows of one run and segment, `per_bin` at a time.
std::vector<Bin> bins_of(const Table& table, std::size_t per_bin) {
  const std::vector<std::uint32_t> ones(table.rows(), 1);
  return neighbours(table.run().index, table.segment().index, ones, per_bin);
}

/// At most `most` bins, where the segments allow it.
std::vector<Bin> bins_within(const Table& table, std::size_t most) {
  std::size_t per_bin = (table.rows() + most - 1) / most;
  std::vector<Bin> bins = bins_of(table, per_bin);
  // Segments cut bins short, so that the first guess may leave too many.
  while (bins.size() > most && per_bin < table.rows())
    bins = bins_of(table, per_bin += per_bin / 4 + 1);
  return bins;
}

/// The run and the segment of each bin.
Table texts_of(const Table& table, const std::vector<Bin>& bins) {
  std::vector<std::size_t> first;
  for (const Bin& bin : bins) first.push_back(bin.begin);
  Table out;
  out.set_run(picked(table.run(), first));
  out.set_run_word(table.run_word());
  out.set_segment(picked(table.segment(), first));
  return out;
}

Table averaged(const Table& table, const std::vector<Bin>& bins) {
  Table out = texts_of(table, bins);
  for (const std::string& name : table.column_names()) {
    out.set_column(name, condensed(name, table.column(name), {}, bins));
  }
  return out;
}

/// The rows in order, without gaps, at most kMostFineRows. Rows that are not `complete` keep their
/// place, for what they tell of the history, and have no observable. Column by column: a table of
/// millions of rows is not copied.
Table in_order(const Table& table, const std::string& observable, const std::vector<bool>& complete,
               std::vector<std::string>& notes) {
  RowOrder order = row_order(table, observable);
  notes.insert(notes.end(), order.notes.begin(), order.notes.end());
  Table texts;
  texts.set_run(picked(table.run(), order.rows));
  texts.set_run_word(table.run_word());
  texts.set_segment(picked(table.segment(), order.rows));
  const std::vector<Bin> bins =
      order.rows.size() > kMostFineRows ? bins_within(texts, kMostFineRows) : bins_of(texts, 1);

  Table out = texts_of(texts, bins);
  std::vector<double> stated_s;
  for (const std::string& name : table.column_names()) {
    std::vector<double> column = picked(table.column(name), order.rows);
    if (name == "time_s") {
      if (!order.time_advances) {
        out.set_dropped(name, "column time_s: stands still or runs backwards");
        continue;
      }
      column = order.time_s;
    }
    if (name == observable) {
      for (std::size_t i = 0; i < column.size(); ++i) {
        if (!complete[order.rows[i]]) column[i] = kMissing;
      }
    } else if (const Status filled = fill_gaps(name, column); !filled) {
      const bool any =
          std::any_of(column.begin(), column.end(), [](double v) { return std::isfinite(v); });
      if (any && !config::is_point_channel(name)) notes.push_back(filled.error().message + ".");
      out.set_dropped(name, filled.error().message);
      continue;
    }
    out.set_column(name, condensed(name, column, {}, bins));
    if (name == "duration_s") stated_s = std::move(column);
  }
  const RowTimes times = times_of(
      texts.run(), order.time_advances ? std::move(order.time_s) : std::vector<double>(), stated_s);
  if (times.usable && !stated_s.empty()) {
    // A window that reaches into its neighbour is as long as the step between them.
    for (std::size_t i = 0; i < stated_s.size(); ++i) {
      stated_s[i] = std::min(stated_s[i], times.duration[i]);
    }
    out.set_column("duration_s", condensed("duration_s", stated_s, {}, bins));
  }
  out.set_column("window_centre_s", condensed("window_centre_s", times.centre, {}, bins));
  out.set_column("window_duration_s", condensed("window_duration_s", times.duration, {}, bins));
  return out;
}

/// Which rows have a measurement.
std::vector<bool> measured(const Table& table, const std::string& observable) {
  const auto values = table.column(observable);
  std::vector<bool> out;
  out.reserve(values.size());
  for (const double v : values) out.push_back(std::isfinite(v));
  return out;
}

/// What the static record did not note stood still.
Table quiet_run(const Table& quiet, const Table& bench, const std::string& observable,
                std::vector<std::string>& notes) {
  const std::vector<bool> complete = measured(quiet, observable);
  const Table rows = in_order(quiet, observable, complete, notes);
  Table out = rows.select(measured(rows, observable));
  for (const std::string& name : bench.column_names()) {
    if (name == "time_s" || name.ends_with("duration_s") || name == "window_centre_s" ||
        name == kStdError || name == observable) {
      continue;
    }
    out.set_column(name, std::vector<double>(out.rows(), bench.column(name).front()));
  }
  out.set_column(kQuietColumn, std::vector<double>(out.rows(), 1.0));
  out.set_run({{"static record"}, std::vector<std::uint32_t>(out.rows(), 0)});
  return out;
}

Windows windows_of(const Table& table) {
  Windows out;
  const auto n = static_cast<Index>(table.rows());
  const auto vector = [&](const char* name) {
    const auto values = table.column(name);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), n));
  };
  for (std::size_t i = 0; i < table.rows(); ++i) {
    if (i == 0 || table.run().index[i] != table.run().index[i - 1]) out.run_begin.push_back(i);
  }
  out.run_begin.push_back(table.rows());
  out.centre_s = vector("window_centre_s");
  out.duration_s = vector("window_duration_s");
  out.white_floor = table.has(kStdError) ? vector(kStdError) : Eigen::VectorXd::Zero(n);
  out.white_floor = out.white_floor.array().isFinite().select(out.white_floor, 0.0).eval();
  out.white_scale = stated_white_scale(out);
  return out;
}

}  // namespace

bool is_made_for_analysis(std::string_view column) {
  return column == kQuietColumn || column == kReadingsColumn || column == "window_centre_s" ||
         column == "window_duration_s";
}

config::ModelTerm quiet_bias() {
  config::ModelTerm term;
  term.effect = "bias_of_the_static_record";
  term.expression = kQuietColumn;
  term.unit = "deg/h";
  return term;
}

Result<WorkingTable> WorkingTable::make(const Table& table, const config::ModelFile& model,
                                        const Table* quiet) {
  for (const Table* its : {&table, quiet}) {
    if (its == nullptr) continue;
    if (Status sized = check_numbers(*its); !sized) return sized.error();
  }
  if (quiet != nullptr && !quiet->has(model.observable)) {
    return Error{ErrorCode::kBadInput, "static record: " + quiet->why_missing(model.observable)};
  }
  const auto complete = complete_rows(table, model);
  if (!complete) return complete.error();
  WorkingTable out;
  out.fine_ = in_order(table, model.observable, *complete, out.notes_);
  MendedTemperature mended = mend_temperature(out.fine_);
  out.resolution_c_ = mended.resolution_c;
  out.notes_.insert(out.notes_.end(), mended.notes.begin(), mended.notes.end());
  if (mended.resolution_c > 0.0) {
    out.fine_.set_column(kReadingsColumn, std::move(mended.readings_c));
  }
  std::vector<bool> counts = measured(out.fine_, model.observable);
  const Table counted = out.fine_.select(counts);
  std::vector<Bin> bins = bins_within(counted, kMostRows);
  out.bench_ = averaged(counted, bins);
  // Between averages of raw samples the samples without a measurement tell nothing more.
  if (bins.size() == counted.rows() && counted.rows() < out.fine_.rows()) out.history_ = out.fine_;
  const auto rows = static_cast<std::size_t>(std::count(complete->begin(), complete->end(), true));
  out.rows_per_bin_ = std::max<std::size_t>(1, rows * table.rows_averaged() / bins.size());
  Table coarse = out.bench_;
  if (quiet != nullptr && quiet->has(model.observable) && quiet->rows() > 0) {
    const Table still = quiet_run(*quiet, out.fine_, model.observable, out.notes_);
    const std::size_t offset = counted.rows();
    out.fine_.set_column(kQuietColumn, std::vector<double>(out.fine_.rows(), 0.0));
    out.fine_.append(still);
    counts.resize(out.fine_.rows(), true);
    const std::vector<Bin> more = bins_within(still, kMostRows);
    coarse.append(averaged(still, more));
    for (const Bin& bin : more) bins.push_back({bin.begin + offset, bin.end + offset});
  }
  for (std::size_t row = 0; row < counts.size(); ++row) {
    if (counts[row]) out.counted_.push_back(static_cast<Index>(row));
  }
  for (const Bin& bin : bins) out.begin_.push_back(bin.begin);
  out.begin_.push_back(out.counted_.size());
  out.windows_ = windows_of(coarse);
  return out;
}

std::vector<std::size_t> WorkingTable::bench_rows_of(const std::vector<std::size_t>& rows) const {
  if (!history_) return rows;
  std::vector<std::size_t> out;
  for (const std::size_t row : rows) {
    const auto at = std::lower_bound(counted_.begin(), counted_.end(), static_cast<Index>(row));
    out.push_back(static_cast<std::size_t>(at - counted_.begin()));
  }
  return out;
}

MatrixXd WorkingTable::average(const MatrixXd& fine_columns) const {
  const auto counted = static_cast<Index>(counted_.size());
  if (counted < fine_columns.rows()) return average_counted(fine_columns(counted_, Eigen::all));
  return average_counted(fine_columns);
}

MatrixXd WorkingTable::average_counted(const MatrixXd& fine_columns) const {
  if (fine_columns.rows() == rows()) return fine_columns;
  MatrixXd out(rows(), fine_columns.cols());
  for (Index i = 0; i < rows(); ++i) {
    const auto from = static_cast<Index>(begin_[static_cast<std::size_t>(i)]);
    const auto to = static_cast<Index>(begin_[static_cast<std::size_t>(i) + 1]);
    out.row(i) = fine_columns.middleRows(from, to - from).colwise().mean();
  }
  return out;
}

}  // namespace fogbench::model
