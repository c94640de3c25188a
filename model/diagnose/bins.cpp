#include "model/diagnose/bins.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>

namespace fogbench::model {
namespace {

constexpr std::size_t kMostRows = 1500;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A neighbourhood of rows that becomes one: same run, same segment, nothing between them.
struct Bin {
  std::size_t begin, end;
};

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

/// Mean of the finite values; NaN when there are none.
double mean(std::span<const double> values, const Bin& bin) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = bin.begin; i < bin.end; ++i) {
    if (!std::isfinite(values[i])) continue;
    sum += values[i];
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : kNan;
}

/// Standard error of the mean of independent values with the given standard errors.
double error_of_mean(std::span<const double> errors, const Bin& bin) {
  double sum = 0.0;
  for (std::size_t i = bin.begin; i < bin.end; ++i) sum += errors[i] * errors[i];
  return std::sqrt(sum) / static_cast<double>(bin.end - bin.begin);
}

TextColumn texts_of(const TextColumn& column, const std::vector<Bin>& bins) {
  TextColumn out{column.values, {}};
  for (const Bin& bin : bins) out.index.push_back(column.index[bin.begin]);
  return out;
}

/// Samples without a stated duration last until the next one.
double duration_of(const Table& table, const Bin& bin) {
  const auto time = table.column("time_s");
  if (table.has("duration_s")) {
    const auto duration = table.column("duration_s");
    return time[bin.end - 1] - time[bin.begin] + 0.5 * (duration[bin.begin] + duration[bin.end - 1]);
  }
  const auto rows = static_cast<double>(bin.end - bin.begin);
  return bin.end - bin.begin > 1 ? (time[bin.end - 1] - time[bin.begin]) * rows / (rows - 1.0) : 0.0;
}

Table averaged(const Table& table, std::size_t per_bin) {
  const std::vector<Bin> bins = bins_of(table, per_bin);
  Table out;
  for (const std::string& name : table.column_names()) {
    const auto values = table.column(name);
    std::vector<double> column;
    column.reserve(bins.size());
    for (const Bin& bin : bins) {
      if (name == "rate_std_error_deg_per_h") {
        column.push_back(error_of_mean(values, bin));
      } else if (name != "duration_s") {
        column.push_back(mean(values, bin));
      }
    }
    if (name != "duration_s") out.set_column(name, std::move(column));
  }
  if (table.has("time_s")) {
    std::vector<double> centre, duration;
    const auto time = table.column("time_s");
    for (const Bin& bin : bins) {
      centre.push_back(0.5 * (time[bin.begin] + time[bin.end - 1]));
      duration.push_back(duration_of(table, bin));
    }
    out.set_column("time_s", std::move(centre));
    out.set_column("duration_s", std::move(duration));
  }
  out.set_run(texts_of(table.run(), bins));
  out.set_segment(texts_of(table.segment(), bins));
  return out;
}

Table bounded(const Table& table) {
  if (table.rows() <= kMostRows) return table;
  // Segments cut bins short, so that the first guess may leave too many.
  std::size_t per_bin = table.rows() / kMostRows + 1;
  while (bins_of(table, per_bin).size() > kMostRows && per_bin < table.rows()) per_bin *= 2;
  return averaged(table, per_bin);
}

/// The static record as a run "quiet" of the bench table: what it did not record stands still.
void join_quiet(Table& table, Table quiet) {
  table.set_column(kQuietColumn, std::vector<double>(table.rows(), 0.0));
  quiet.set_column(kQuietColumn, std::vector<double>(quiet.rows(), 1.0));
  for (const std::string& name : table.column_names()) {
    if (name == "time_s" || name == "duration_s" || name == "rate_std_error_deg_per_h" ||
        name == "rate_deg_per_h" || name == kQuietColumn) {
      continue;
    }
    const auto values = table.column(name);
    const double still = values.empty() ? 0.0 : values.front();
    quiet.set_column(name, std::vector<double>(quiet.rows(), still));
  }
  quiet.set_run({{"quiet"}, std::vector<std::uint32_t>(quiet.rows(), 0)});
  table.append(quiet);
}

}  // namespace

config::ModelTerm quiet_bias() {
  config::ModelTerm term;
  term.effect = "bias_of_the_static_record";
  term.expression = kQuietColumn;
  term.unit = "deg/h";
  return term;
}

Result<BinnedTable> table_for_diagnosis(const Table& table, const config::ModelFile& model,
                                        const Table* quiet) {
  if (!table.has(model.observable)) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("the table has no column {}, the model's observable",
                             model.observable)};
  }
  std::vector<bool> keep(table.rows());
  const auto observed = table.column(model.observable);
  for (std::size_t i = 0; i < table.rows(); ++i) keep[i] = std::isfinite(observed[i]);
  if (std::none_of(keep.begin(), keep.end(), [](bool k) { return k; })) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("column {} has no number in any row", model.observable)};
  }
  BinnedTable out;
  out.table = bounded(table.select(keep));
  out.rows_per_bin = table.rows() / std::max<std::size_t>(out.table.rows(), 1);
  if (quiet != nullptr && quiet->rows() > 0 && quiet->has(model.observable)) {
    join_quiet(out.table, bounded(*quiet));
    out.has_quiet_run = true;
  }
  return out;
}

}  // namespace fogbench::model
