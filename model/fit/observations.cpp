#include "model/fit/observations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/noise/stated_errors.hpp"
#include "model/table/median.hpp"

namespace fogbench::model {
namespace {

Eigen::Index index_of(std::size_t i) {
  return static_cast<Eigen::Index>(i);
}

}  // namespace

Result<Observations> Observations::make(const Signals& signals, const Design& design,
                                        const std::string& observable, const std::string& weight_by,
                                        const std::vector<std::size_t>& left_out) {
  Observations result(signals, design);
  result.observable_ = observable;
  const Table& table = signals.table();
  std::vector<std::string> needed = design.signals_needed();
  needed.push_back(observable);
  if (!weight_by.empty()) needed.push_back(weight_by);
  std::vector<Signals::View> views;
  for (const std::string& name : needed) {
    if (!signals.available(name) && !table.has(name))
      return config::bad_input(table.why_missing(name));
    views.push_back(signals.signal(name));
  }
  std::vector<double> sigma;
  result.place_.assign(signals.rows(), -1);
  for (std::size_t row = 0; row < signals.rows(); ++row) {
    const bool complete = std::none_of(views.begin(), views.end(), [&](const Signals::View& v) {
      return std::isnan(v[index_of(row)]);
    });
    if (!complete) continue;
    const std::size_t its = signals.table_row(row);
    if (std::find(left_out.begin(), left_out.end(), its) != left_out.end()) continue;
    if (!weight_by.empty()) {
      sigma.push_back(views.back()[index_of(row)]);
      if (!(sigma.back() > 0.0)) {
        return config::bad_input(
            fmt::format("column {}: found {} in row {} of the data, expected a positive "
                        "standard deviation",
                        weight_by, sigma.back(), signals.table_row(row) + 1));
      }
    }
    result.place_[row] = index_of(result.taken_.size());
    result.taken_.push_back(row);
  }
  if (result.taken_.empty()) {
    for (std::size_t i = 0; i < needed.size(); ++i) {
      if (!signals.available(needed[i])) {
        return config::bad_input(
            fmt::format("column {}: found no number in any row, expected some", needed[i]));
      }
    }
    return config::bad_input(
        "found no row in which every column that the model needs has a number");
  }
  result.lengths_s_ = result.window_lengths();
  if (!sigma.empty()) result.sigma_ = Eigen::VectorXd::Map(sigma.data(), index_of(sigma.size()));
  return result;
}

Eigen::VectorXd Observations::observed() const {
  const Signals::View all = signals_->signal(observable_);
  Eigen::VectorXd result(index_of(taken_.size()));
  for (std::size_t i = 0; i < taken_.size(); ++i) result[index_of(i)] = all[index_of(taken_[i])];
  return result;
}

Eigen::VectorXd Observations::window_lengths() const {
  if (!signals_->table().has("time_s")) return {};
  if (signals_->table().has("duration_s")) return signals_->signal("duration_s");
  const Signals::View time = signals_->signal("time_s");
  Eigen::VectorXd to_next = Eigen::VectorXd::Constant(time.size(), kMissing);
  std::vector<double> steps;
  for (const Signals::RunRange& run : signals_->runs()) {
    for (std::size_t i = run.begin; i + 1 < run.end; ++i) {
      const double step = time[index_of(i + 1)] - time[index_of(i)];
      to_next[index_of(i)] = step;
      if (step > 0.0) steps.push_back(step);
    }
  }
  const double usual = steps.empty() ? kUntimedWindow_s : median(std::move(steps));
  Eigen::VectorXd out(time.size());
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    out[i] = usual;
    if (to_next[i] > 0.0) out[i] = std::min(out[i], to_next[i]);
    if (i > 0 && to_next[i - 1] > 0.0) out[i] = std::min(out[i], to_next[i - 1]);
  }
  return out;
}

Result<Windows> Observations::row_windows() const {
  if (!signals_->table().has("time_s")) {
    return config::bad_input(signals_->table().why_missing("time_s"));
  }
  const Signals::View time = signals_->signal("time_s");
  const bool stated = signals_->available("rate_std_error_deg_per_h");
  const Signals::View error =
      stated ? signals_->signal("rate_std_error_deg_per_h") : Signals::View(nullptr, 0);
  Windows windows;
  const Eigen::Index count = index_of(taken_.size());
  windows.centre_s.resize(count);
  windows.duration_s.resize(count);
  windows.white_floor = Eigen::VectorXd::Zero(count);
  std::size_t i = 0;
  for (const Signals::RunRange& run : signals_->runs()) {
    if (i < taken_.size() && taken_[i] < run.end) windows.run_begin.push_back(i);
    for (; i < taken_.size() && taken_[i] < run.end; ++i) {
      const Eigen::Index row = index_of(taken_[i]);
      windows.centre_s[index_of(i)] = time[row];
      windows.duration_s[index_of(i)] = lengths_s_[row];
      if (stated && error[row] > 0.0) windows.white_floor[index_of(i)] = error[row];
    }
  }
  windows.run_begin.push_back(taken_.size());
  if (Status checked = check_windows(windows); !checked) return checked.error();
  return windows;
}

Windows Observations::row_windows_or_sequence() const {
  if (auto windows = row_windows()) return std::move(*windows);
  Windows out;
  const Eigen::Index count = index_of(taken_.size());
  std::size_t i = 0;
  for (const Signals::RunRange& run : signals_->runs()) {
    if (i < taken_.size() && taken_[i] < run.end) out.run_begin.push_back(i);
    while (i < taken_.size() && taken_[i] < run.end) ++i;
  }
  out.run_begin.push_back(taken_.size());
  out.duration_s = Eigen::VectorXd::Constant(count, kUntimedWindow_s);
  out.centre_s =
      kUntimedWindow_s * Eigen::VectorXd::LinSpaced(count, 0.5, static_cast<double>(count) - 0.5);
  out.white_floor = Eigen::VectorXd::Zero(count);
  return out;
}

Status Observations::use_windows(std::size_t bins) {
  Result<Windows> rows = row_windows();
  if (!rows) return rows.error();
  const std::size_t group = (taken_.size() + bins - 1) / bins;
  bin_of_.resize(taken_.size());
  windows_ = {};
  std::vector<double> centre, duration, floor;
  for (std::size_t run = 0; run + 1 < rows->run_begin.size(); ++run) {
    windows_.run_begin.push_back(centre.size());
    for (std::size_t i = rows->run_begin[run]; i < rows->run_begin[run + 1]; i += group) {
      const std::size_t end = std::min(i + group, rows->run_begin[run + 1]);
      const Eigen::Index first = index_of(i), count = index_of(end - i);
      const auto length = rows->duration_s.segment(first, count);
      const auto stated = rows->white_floor.segment(first, count);
      const double total = length.sum();
      centre.push_back(rows->centre_s.segment(first, count).dot(length) / total);
      duration.push_back(total);
      const bool all_stated = (stated.array() > 0.0).all();
      floor.push_back(all_stated ? length.cwiseProduct(stated).norm() / total : 0.0);
      std::fill(bin_of_.begin() + first, bin_of_.begin() + first + count,
                index_of(centre.size()) - 1);
    }
  }
  windows_.run_begin.push_back(centre.size());
  const auto vector = [](const std::vector<double>& v) -> Eigen::VectorXd {
    return Eigen::VectorXd::Map(v.data(), static_cast<Eigen::Index>(v.size()));
  };
  windows_.centre_s = vector(centre);
  windows_.duration_s = vector(duration);
  windows_.white_floor = vector(floor);
  windows_.white_scale = stated_white_scale(windows_);
  return {};
}

std::optional<Eigen::MatrixXd> Observations::triangle(const Eigen::VectorXd& inner,
                                                      bool with_tangents) const {
  if (whitener_ != nullptr) {
    Eigen::MatrixXd rows = window_rows(inner, with_tangents);
    if (!rows.allFinite()) return {};
    Reduction reduction(rows.cols());
    reduction.add(whitener_->whiten(rows));
    return reduction.triangle();
  }
  std::optional<Reduction> reduction;
  bool finite = true;
  const auto add = [&](std::size_t begin, Eigen::Ref<Eigen::MatrixXd> rows) {
    if (!reduction) reduction.emplace(rows.cols());
    std::vector<Eigen::Index> chosen;
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
      const Eigen::Index place = place_[begin + static_cast<std::size_t>(row)];
      if (place < 0) continue;
      if (sigma_.size() > 0) rows.row(row) /= sigma_[place];
      chosen.push_back(row);
    }
    if (index_of(chosen.size()) == rows.rows()) {
      finite = finite && rows.allFinite();
      if (finite) reduction->add(rows);
      return;
    }
    const Eigen::MatrixXd kept = rows(chosen, Eigen::all);
    finite = finite && kept.allFinite();
    if (finite) reduction->add(kept);
  };
  design_->visit(inner, with_tangents, signals_->signal(observable_), add);
  if (!finite) return {};
  return reduction->triangle();
}

Eigen::MatrixXd Observations::rows(const Eigen::VectorXd& inner, bool with_tangents) const {
  Eigen::MatrixXd out;
  const auto add = [&](std::size_t begin, Eigen::Ref<Eigen::MatrixXd> rows) {
    if (out.size() == 0) out.resize(index_of(taken_.size()), rows.cols());
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
      const Eigen::Index place = place_[begin + static_cast<std::size_t>(row)];
      if (place >= 0) out.row(place) = rows.row(row);
    }
  };
  design_->visit(inner, with_tangents, signals_->signal(observable_), add);
  return out;
}

Eigen::MatrixXd Observations::window_rows(const Eigen::VectorXd& inner, bool with_tangents) const {
  Eigen::MatrixXd sums;
  const auto add = [&](std::size_t begin, Eigen::Ref<Eigen::MatrixXd> rows) {
    if (sums.size() == 0) sums = Eigen::MatrixXd::Zero(windows_.rows(), rows.cols());
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
      const std::size_t at = begin + static_cast<std::size_t>(row);
      if (place_[at] < 0) continue;
      const Eigen::Index bin = bin_of_[static_cast<std::size_t>(place_[at])];
      sums.row(bin) += lengths_s_[index_of(at)] / windows_.duration_s[bin] * rows.row(row);
    }
  };
  design_->visit(inner, with_tangents, signals_->signal(observable_), add);
  return sums;
}

std::optional<std::pair<std::size_t, std::size_t>> Observations::not_finite(
    const Eigen::VectorXd& inner) const {
  for (std::size_t term = 0; term < design_->terms(); ++term) {
    const Eigen::MatrixXd values = design_->regressor(term, inner);
    for (const std::size_t row : taken_) {
      if (!values.row(index_of(row)).allFinite()) return std::pair(term, signals_->table_row(row));
    }
  }
  return {};
}

}  // namespace fogbench::model
