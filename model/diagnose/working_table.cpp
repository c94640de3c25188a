#include "model/diagnose/working_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "model/design.hpp"
#include "model/signals.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr std::size_t kMostFineRows = 30'000;
constexpr std::size_t kMostRows = 800;
// A column with fewer numbers than this share cannot be filled from its neighbours.
constexpr double kLeastFilled = 0.5;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kStdError = "rate_std_error_deg_per_h";

struct Bin {
  std::size_t begin, end;
};

/// The table's rows at `order`.
Table permuted(const Table& table, const std::vector<std::size_t>& order) {
  Table out;
  for (const std::string& name : table.column_names()) {
    const auto values = table.column(name);
    std::vector<double> column;
    column.reserve(order.size());
    for (const std::size_t row : order) column.push_back(values[row]);
    out.set_column(name, std::move(column));
  }
  const auto texts = [&](const TextColumn& from) {
    TextColumn to{from.values, {}};
    to.index.reserve(order.size());
    for (const std::size_t row : order) to.index.push_back(from.index[row]);
    return to;
  };
  out.set_run(texts(table.run()));
  out.set_segment(texts(table.segment()));
  return out;
}

/// Runs by name ("2" before "10"), rows by time; a row without a time follows the one before it. A
/// row that repeats the time and the value of the one before it was written twice and counts once.
std::vector<std::size_t> order_of(const Table& table, const std::string& observable,
                                  const std::vector<std::size_t>& rows) {
  std::vector<double> time(table.rows(), 0.0);
  if (table.has("time_s")) {
    const auto given = table.column("time_s");
    std::copy(given.begin(), given.end(), time.begin());
    for (std::size_t i = 0; i < time.size(); ++i) {
      if (std::isnan(time[i])) time[i] = i > 0 ? time[i - 1] : 0.0;
    }
  }
  std::vector<std::size_t> rank(table.run().values.size());
  std::vector<std::size_t> sorted(rank.size());
  std::iota(sorted.begin(), sorted.end(), std::size_t{0});
  std::sort(sorted.begin(), sorted.end(), [&](std::size_t a, std::size_t b) {
    const std::string &s = table.run().values[a], &t = table.run().values[b];
    return std::pair(s.size(), s) < std::pair(t.size(), t);
  });
  for (std::size_t i = 0; i < sorted.size(); ++i) rank[sorted[i]] = i;

  std::vector<std::size_t> order = rows;
  const auto key = [&](std::size_t row) {
    return std::pair(rank[table.run().index[row]], time[row]);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  if (!table.has("time_s")) return order;
  const auto value = table.column(observable);
  const auto repeats = [&](std::size_t a, std::size_t b) {
    return key(a) == key(b) && value[a] == value[b];
  };
  order.erase(std::unique(order.begin(), order.end(), repeats), order.end());
  return order;
}

/// Rows on which the model can be evaluated.
Result<std::vector<std::size_t>> complete_rows(const Table& table, const config::ModelFile& model) {
  if (!table.has(model.observable)) {
    return Error{ErrorCode::kBadInput, table.why_missing(model.observable)};
  }
  const Signals signals(table, model.reference_temperature_c);
  const auto design = Design::make(signals, model, false);
  if (!design) return design.error();
  const auto complete = [&](std::size_t row) {
    return std::isfinite(table.column(model.observable)[row]);
  };
  std::vector<std::string> needed;
  for (const std::string& name : design->signals_needed()) {
    if (table.has(name)) needed.push_back(name);
  }
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const bool all = complete(row) && std::all_of(needed.begin(), needed.end(), [&](const auto& n) {
                       return std::isfinite(table.column(n)[row]);
                     });
    if (all) rows.push_back(row);
  }
  if (rows.empty()) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("found no row with {} and every signal of the model, expected some",
                             model.observable)};
  }
  return rows;
}

/// Fills gaps with the number before (or, at the start, after) them; a column that is mostly gaps
/// is dropped.
void fill_gaps(Table& table) {
  for (const std::string& name : table.column_names()) {
    const auto values = table.column(name);
    const auto filled =
        std::count_if(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
    if (filled == static_cast<std::ptrdiff_t>(values.size())) continue;
    if (static_cast<double>(filled) < kLeastFilled * static_cast<double>(values.size())) {
      table.set_dropped(name, fmt::format("column {}: has a number in {} of {} rows, expected more",
                                          name, filled, values.size()));
      continue;
    }
    std::vector<double> column(values.begin(), values.end());
    double last =
        *std::find_if(column.begin(), column.end(), [](double v) { return std::isfinite(v); });
    for (double& v : column) {
      if (std::isfinite(v)) last = v;
      v = last;
    }
    table.set_column(name, std::move(column));
  }
}

/// Gives every row a centre and a duration, windows of a run never overlapping. A time that does
/// not advance is of no use: then the rows follow each other.
void set_windows(Table& table) {
  const auto n = table.rows();
  std::vector<double> time(n), duration(n, 0.0);
  const auto& run = table.run().index;
  const bool timed = table.has("time_s");
  if (timed) std::copy_n(table.column("time_s").begin(), n, time.begin());
  bool advances = timed;
  std::vector<double> steps;
  for (std::size_t i = 1; i < n; ++i) {
    if (run[i] != run[i - 1]) continue;
    steps.push_back(time[i] - time[i - 1]);
    advances = advances && steps.back() > 0.0;
  }
  if (!advances) {
    if (timed) table.set_dropped("time_s", "column time_s: stands still or runs backwards");
    for (std::size_t i = 0; i < n; ++i) time[i] = static_cast<double>(i);
    duration.assign(n, 1.0);
  } else {
    double usual = 1.0;
    if (!steps.empty()) {
      std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                       steps.end());
      usual = steps[steps.size() / 2];
    }
    if (table.has("duration_s")) {
      std::copy_n(table.column("duration_s").begin(), n, duration.begin());
    }
    for (double& d : duration) d = d > 0.0 ? d : usual;
    for (std::size_t i = 1; i < n; ++i) {
      if (run[i] != run[i - 1]) continue;
      const double gap = time[i] - time[i - 1];
      const double half = 0.5 * (duration[i] + duration[i - 1]);
      if (half <= gap) continue;
      duration[i] *= gap / half;
      duration[i - 1] *= gap / half;
    }
  }
  if (advances) table.set_column("time_s", time);
  table.set_column("window_centre_s", std::move(time));
  table.set_column("window_duration_s", std::move(duration));
}

/// Neighbouring rows of one run and segment, `per_bin` at a time.
std::vector<Bin> bins_of(const Table& table, std::size_t per_bin) {
  std::vector<Bin> bins;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const bool fresh = bins.empty() || i - bins.back().begin >= per_bin ||
                       table.run().index[i] != table.run().index[i - 1] ||
                       table.segment().index[i] != table.segment().index[i - 1];
    if (fresh) bins.push_back({i, i});
    bins.back().end = i + 1;
  }
  return bins;
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

Table averaged(const Table& table, const std::vector<Bin>& bins) {
  Table out;
  for (const std::string& name : table.column_names()) {
    const auto values = table.column(name);
    std::vector<double> column;
    column.reserve(bins.size());
    for (const Bin& bin : bins) {
      const auto count = static_cast<double>(bin.end - bin.begin);
      double sum = 0.0;
      for (std::size_t i = bin.begin; i < bin.end; ++i) {
        sum += name == kStdError ? values[i] * values[i] : values[i];
      }
      if (name == kStdError) {
        column.push_back(std::sqrt(sum) / count);
      } else {
        column.push_back(name.ends_with("duration_s") ? sum : sum / count);
      }
    }
    out.set_column(name, std::move(column));
  }
  const auto texts = [&](const TextColumn& from) {
    TextColumn to{from.values, {}};
    for (const Bin& bin : bins) to.index.push_back(from.index[bin.begin]);
    return to;
  };
  out.set_run(texts(table.run()));
  out.set_segment(texts(table.segment()));
  return out;
}

Table in_order(const Table& table, const std::string& observable,
               const std::vector<std::size_t>& rows) {
  Table out = permuted(table, order_of(table, observable, rows));
  fill_gaps(out);
  set_windows(out);
  if (out.rows() > kMostFineRows) out = averaged(out, bins_within(out, kMostFineRows));
  return out;
}

/// What the static record did not note stood still.
Table quiet_run(const Table& quiet, const Table& bench, const std::string& observable) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < quiet.rows(); ++i) {
    if (std::isfinite(quiet.column(observable)[i])) rows.push_back(i);
  }
  Table out = in_order(quiet, observable, rows);
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
  return out;
}

}  // namespace

config::ModelTerm quiet_bias() {
  config::ModelTerm term;
  term.effect = "bias_of_the_static_record";
  term.expression = kQuietColumn;
  term.unit = "deg/h";
  return term;
}

Result<WorkingTable> WorkingTable::make(const Table& table, const config::ModelFile& model,
                                        const Table* quiet) {
  const auto rows = complete_rows(table, model);
  if (!rows) return rows.error();
  WorkingTable out;
  out.fine_ = in_order(table, model.observable, *rows);
  std::vector<Bin> bins = bins_within(out.fine_, kMostRows);
  out.bench_ = averaged(out.fine_, bins);
  out.rows_per_bin_ = std::max<std::size_t>(1, rows->size() / bins.size());
  Table coarse = out.bench_;
  if (quiet != nullptr && quiet->has(model.observable) && quiet->rows() > 0) {
    const Table still = quiet_run(*quiet, out.fine_, model.observable);
    const std::size_t offset = out.fine_.rows();
    out.fine_.set_column(kQuietColumn, std::vector<double>(offset, 0.0));
    out.fine_.append(still);
    const std::vector<Bin> more = bins_within(still, kMostRows);
    coarse.append(averaged(still, more));
    for (const Bin& bin : more) bins.push_back({bin.begin + offset, bin.end + offset});
  }
  for (const Bin& bin : bins) out.begin_.push_back(bin.begin);
  out.begin_.push_back(out.fine_.rows());
  out.windows_ = windows_of(coarse);
  return out;
}

MatrixXd WorkingTable::average(const MatrixXd& fine_columns) const {
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
