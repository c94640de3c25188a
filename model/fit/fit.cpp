#include "model/fit/fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <optional>

#include "config/units.hpp"
#include "model/fit/fit_lag.hpp"
#include "model/fit/fit_warnings.hpp"
#include "model/fit/fitted_model.hpp"
#include "model/fit/gls.hpp"
#include "model/fit/inner_search.hpp"
#include "model/fit/observations.hpp"
#include "model/fit/unexcited.hpp"
#include "model/noise/stated_errors.hpp"
#include "model/table/bad_rows.hpp"
#include "model/table/row_order.hpp"

namespace fogbench::model {
namespace {

/// Two-sided probability of k = 2 for a normal deviate.
constexpr double kCoverage = 0.954499736;
/// Coloured noise is estimated on at most this many windows.
constexpr std::size_t kMostFittedWindows = 10'000;
/// Below this many rows beyond the unknowns a noise spectrum cannot be told from a constant.
constexpr std::size_t kEnoughRows = 20;
// Uncertainties that a lag lets grow by less than this share are not worth a word.
constexpr double kWorthSaying = 0.1;

/// One fit under way: the system, and what has been found so far.
struct FitWork {
  const Table& table;
  const config::ModelFile& model;
  const FitOptions& options;
  const Signals& signals;
  const Design& design;
  Observations& observations;
  FitResult result;
  Eigen::VectorXd inner;
  Eigen::VectorXd beta;        ///< of the free columns, the starts' after the model's own
  Eigen::MatrixXd covariance;  ///< of [free columns, inner], NaN where not determined
  Eigen::VectorXd
      variance_at_inner;  ///< of the free columns, the inner parameters held; may be empty
  double coverage = 2.0;  ///< factor of the expanded uncertainty

  Eigen::Index free() const { return static_cast<Eigen::Index>(design.free_columns().size()); }
  Eigen::Index unknowns() const { return free() + inner.size(); }
};

struct Linearised {
  Eigen::MatrixXd x;
  Eigen::VectorXd y;
};

/// X, T = dy/da at the current solution, and y, from rows [X D y] of the observations.
Linearised linearise(const FitWork& work, const Eigen::MatrixXd& rows) {
  const Eigen::Index free = work.free();
  Linearised result{Eigen::MatrixXd::Zero(rows.rows(), work.unknowns()), rows.col(rows.cols() - 1)};
  result.x.leftCols(free) = rows.leftCols(free);
  const std::vector<Tangent> tangents = work.design.tangents();
  for (std::size_t i = 0; i < tangents.size(); ++i) {
    const Tangent& tangent = tangents[i];
    const double coefficient = tangent.column < 0 ? tangent.held : work.beta[tangent.column];
    result.x.col(free + tangent.parameter) +=
        coefficient * rows.col(free + static_cast<Eigen::Index>(i));
  }
  return result;
}

/// "a, b and c"
std::string listed(const std::vector<std::string>& names) {
  if (names.size() < 2) return names.empty() ? "" : names.front();
  return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

void warn_of_dependence(FitWork& work, const LinearFit& fit) {
  const std::vector<Eigen::Index> free = work.design.free_columns();
  const auto name = [&](Eigen::Index column) {
    const auto at = static_cast<std::size_t>(free[static_cast<std::size_t>(column)]);
    return work.design.columns()[at].name;
  };
  const auto is_start = [&](Eigen::Index column) {
    const auto at = static_cast<std::size_t>(free[static_cast<std::size_t>(column)]);
    return work.design.columns()[at].start;
  };
  for (const std::vector<Eigen::Index>& group : fit.dependent) {
    if (is_start(group.front())) continue;  // more freedom than these data have a use for
    const std::string left_out = name(group.front());
    if (group.size() == 1) {
      work.result.warnings.push_back(fmt::format(
          "{} cannot be determined: its term is zero in every row; it is left out", left_out));
      continue;
    }
    std::vector<std::string> rest;
    for (std::size_t i = 1; i < group.size(); ++i) rest.push_back(name(group[i]));
    work.result.warnings.push_back(fmt::format(
        "these data cannot separate {} from {}: {} is left out, what remains stands for the sum",
        left_out, listed(rest), left_out));
  }
}

/// Covariance of [free columns, inner] from the triangle [X kept | T | y], times `variance`.
Eigen::MatrixXd joint_covariance(const LinearFit& fit, Eigen::Index free, Eigen::Index q,
                                 double variance) {
  const auto kept = static_cast<Eigen::Index>(fit.kept.size());
  std::vector<Eigen::Index> place = fit.kept;
  for (Eigen::Index i = 0; i < q; ++i) place.push_back(free + i);
  const std::vector<Eigen::Index> independent = independent_columns(fit.joint, kept + q);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(free + q, free + q, kMissing);
  if (independent.empty()) return covariance;
  Reduction reduction(static_cast<Eigen::Index>(independent.size()));
  reduction.add(fit.joint(Eigen::all, independent));
  const Eigen::MatrixXd inverse = variance * inverse_gram(reduction.triangle());
  std::vector<Eigen::Index> chosen;
  for (const Eigen::Index i : independent) chosen.push_back(place[static_cast<std::size_t>(i)]);
  covariance(chosen, chosen) = inverse;
  return covariance;
}

void warn_of_calendar(FitWork& work) {
  const std::vector<std::string> needed = work.design.signals_needed();
  const bool counts =
      std::find(needed.begin(), needed.end(), "time_since_power_on_s") != needed.end();
  if (!counts || !has_calendar_time(work.signals)) return;
  work.result.warnings.emplace_back(kCalendarNote);
}

Status fit_independent(FitWork& work) {
  Result<InnerSolution> solution = search_inner(work.observations);
  if (!solution) return solution.error();
  const LinearFit& fit = solution->fit;
  work.inner = solution->inner;
  work.beta = fit.beta;
  const auto used = static_cast<double>(fit.kept.size()) + static_cast<double>(work.inner.size());
  const double dof = static_cast<double>(work.observations.taken().size()) - used;
  work.result.degrees_of_freedom = dof;
  const double variance = dof > 0.0 ? fit.residual_sum_of_squares / dof : kMissing;
  work.covariance = joint_covariance(fit, work.free(), work.inner.size(), variance);
  work.coverage = coverage_factor(dof);
  warn_of_dependence(work, fit);
  if (!(dof > 0.0)) {
    work.result.warnings.push_back(
        "as many unknowns as rows: no degrees of freedom are left, the uncertainty is unknown");
  }
  return {};
}

/// Noise by restricted likelihood and coefficients by generalised least squares, in turn with the
/// inner parameters under the whitened residual. `work` holds the independent solution.
Status fit_coloured(FitWork& work) {
  Result<NoiseShapes> shapes = NoiseShapes::make(work.observations.windows(), work.options.prior);
  if (!shapes) return shapes.error();
  std::optional<GlsResult> last;
  // The noise settles in two or three turns: its shape comes from a coarse grid.
  const int turns = work.inner.size() > 0 ? 3 : 1;
  for (int turn = 0; turn < turns; ++turn) {
    if (last) {
      Result<std::unique_ptr<Whitener>> whitener =
          make_whitener(work.observations.windows(), last->noise.noise);
      if (!whitener) return whitener.error();
      work.observations.set_whitener(std::move(*whitener));
      Result<InnerSolution> solution = refine_inner(work.observations, work.inner);
      if (!solution) return solution.error();
      work.inner = solution->inner;
      work.beta = solution->fit.beta;
    }
    const Linearised system =
        linearise(work, work.observations.window_rows(work.inner, work.inner.size() > 0));
    Result<GlsResult> found = gls(*shapes, system.x, system.y);
    if (!found) return found.error();
    last = std::move(*found);
    work.beta = last->beta.head(work.free());
    if (work.inner.size() == 0) continue;
    // The joint solution would move the inner parameters too, far where one stands at its bound or
    // is hardly seen. They stay where the search left them, and the coefficients are theirs.
    Result<GlsResult> held = gls(*shapes, system.x.leftCols(work.free()), system.y);
    if (!held) return held.error();
    work.beta = held->beta;
    work.variance_at_inner = held->covariance.diagonal();
  }
  work.covariance = last->covariance;
  work.coverage = last->coverage_factor;
  work.result.noise = last->noise;
  work.result.degrees_of_freedom = last->degrees_of_freedom;
  work.result.coloured = true;
  return {};
}

/// Whether coloured noise is to be estimated; an error when it was asked for and cannot be.
Result<bool> choose_coloured(FitWork& work) {
  const FitOptions::Noise wanted = work.options.noise;
  if (wanted == FitOptions::Noise::kIndependent) return false;
  if (!work.options.weight_by.empty()) {
    if (wanted == FitOptions::Noise::kAuto) return false;
    return Error{ErrorCode::kBadInput,
                 "coloured noise and weights by a column exclude each other, expected one"};
  }
  const bool enough =
      work.observations.taken().size() >= static_cast<std::size_t>(work.unknowns()) + kEnoughRows;
  const bool timed = work.table.has("time_s");
  if (wanted == FitOptions::Noise::kAuto && (!timed || !enough)) return false;
  const Status windows = work.observations.use_windows(kMostFittedWindows);
  if (windows) return true;
  if (wanted == FitOptions::Noise::kColoured) return windows.error();
  work.result.warnings.push_back("the noise is taken as independent: " + windows.error().message);
  return false;
}

/// All columns' coefficients, held and free.
Eigen::VectorXd all_coefficients(const FitWork& work) {
  const std::vector<DesignColumn>& columns = work.design.columns();
  Eigen::VectorXd all(static_cast<Eigen::Index>(columns.size()));
  Eigen::Index next = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    all[static_cast<Eigen::Index>(i)] = columns[i].held ? *columns[i].given : work.beta[next++];
  }
  return all;
}

/// Predicted values, residuals and their size; needs degrees_of_freedom.
void fill_residuals(FitWork& work) {
  FitResult& result = work.result;
  const Eigen::VectorXd everywhere = work.design.predict(all_coefficients(work), work.inner);
  const std::vector<std::size_t>& taken = work.observations.taken();
  const auto count = static_cast<Eigen::Index>(taken.size());
  result.predicted.resize(count);
  result.rows.resize(taken.size());
  for (std::size_t i = 0; i < taken.size(); ++i) {
    result.rows[i] = work.signals.table_row(taken[i]);
    result.predicted[static_cast<Eigen::Index>(i)] =
        everywhere[static_cast<Eigen::Index>(taken[i])];
  }
  result.residual = work.observations.observed() - result.predicted;
  result.residual_sum_of_squares = result.residual.squaredNorm();
  result.rms = std::sqrt(result.residual_sum_of_squares / static_cast<double>(count));
  result.residual_standard_deviation =
      result.degrees_of_freedom > 0.0
          ? std::sqrt(result.residual_sum_of_squares / result.degrees_of_freedom)
          : kMissing;
}

/// Independent noise: sigma is estimated, as a whole or as a factor on the weights.
void fill_independent_noise(FitWork& work) {
  FitResult& result = work.result;
  const Eigen::VectorXd& sigma = work.observations.sigma();
  const Eigen::VectorXd scale =
      sigma.size() > 0 ? sigma : Eigen::VectorXd::Ones(result.residual.size());
  const double dof = result.degrees_of_freedom;
  const double factor =
      dof > 0.0 ? std::sqrt(result.residual.cwiseQuotient(scale).squaredNorm() / dof) : kMissing;
  result.standard_deviation = factor * scale;
  result.whitened = result.residual.cwiseQuotient(result.standard_deviation);
  result.noise.says = "independent, its size estimated from the residual";
}

/// Coloured noise on the rows themselves. Where windows were joined, a row's own white noise comes
/// on top of its window's deviation, and no correlation is removed.
Status fill_coloured_noise(FitWork& work) {
  FitResult& result = work.result;
  Result<std::unique_ptr<Whitener>> whitener =
      make_whitener(work.observations.windows(), result.noise.noise);
  if (!whitener) return whitener.error();
  result.windows = work.observations.windows();
  result.window_of = work.observations.bin_of();
  result.white_beside_windows = 0.0;
  for (std::size_t i = 0; i < result.window_of.size(); ++i) {
    result.white_beside_windows += 3600.0 / work.observations.length_s(i) -
                                   3600.0 / result.windows.duration_s[result.window_of[i]];
  }
  result.white_beside_windows /= static_cast<double>(result.window_of.size());
  const Eigen::VectorXd deviation = (*whitener)->standard_deviation();
  const std::vector<Eigen::Index>& bin_of = work.observations.bin_of();
  if (work.observations.windows().rows() == result.residual.size()) {
    result.standard_deviation = deviation;
    result.whitened = (*whitener)->whiten(result.residual);
    return {};
  }
  const double n = result.noise.noise.angle_random_walk_deg_per_sqrt_h;
  result.standard_deviation.resize(result.residual.size());
  for (std::size_t i = 0; i < bin_of.size(); ++i) {
    const double own = work.observations.length_s(i);
    const double joined = work.observations.windows().duration_s[bin_of[i]];
    const double white = n * n * 3600.0 * (1.0 / own - 1.0 / joined);
    result.standard_deviation[static_cast<Eigen::Index>(i)] =
        std::sqrt(deviation[bin_of[i]] * deviation[bin_of[i]] + white);
  }
  result.whitened = result.residual.cwiseQuotient(result.standard_deviation);
  return {};
}

/// Estimates with their uncertainty, and warnings of inner parameters that are not identified.
void fill_estimates(FitWork& work) {
  FitResult& result = work.result;
  const auto error_of = [&](Eigen::Index i) { return std::sqrt(work.covariance(i, i)); };
  Eigen::Index next = 0;
  std::vector<Eigen::Index> reported;  // of the free columns and inner parameters
  for (std::size_t i = 0; i < work.design.own_columns(); ++i) {
    const DesignColumn& column = work.design.columns()[i];
    if (column.held) {
      result.estimates.push_back({column.name, column.unit, *column.given, 0.0, 2.0, true});
      continue;
    }
    // A column that was left out has no covariance and a zero coefficient.
    const bool left_out = std::isnan(work.covariance(next, next)) && work.beta[next] == 0.0;
    result.estimates.push_back({column.name, column.unit, left_out ? kMissing : work.beta[next],
                                error_of(next), work.coverage, false});
    if (next < work.variance_at_inner.size()) {
      result.estimates.back().error_at_inner = std::sqrt(work.variance_at_inner[next]);
    }
    reported.push_back(next++);
  }
  next = work.free();  // past the starts
  for (std::size_t i = 0; i < work.design.parameters().size(); ++i, ++next) {
    reported.push_back(next);
    const DesignParameter& parameter = work.design.parameters()[i];
    const double value = work.inner[static_cast<Eigen::Index>(i)];
    result.estimates.push_back(
        {parameter.name, parameter.unit, value, error_of(next), work.coverage, false, true});
    if (std::isnan(error_of(next)) && result.degrees_of_freedom > 0.0) {
      result.warnings.push_back(
          fmt::format("{} has no influence on these data: it is not determined", parameter.name));
    }
    if (!parameter.range) continue;
    const double slack = 1e-3 * (parameter.range->maximum - parameter.range->minimum);
    const bool log_scale = parameter.range->logarithmic;
    const double low =
        log_scale ? parameter.range->minimum * 1.001 : parameter.range->minimum + slack;
    const double high =
        log_scale ? parameter.range->maximum * 0.999 : parameter.range->maximum - slack;
    if (value <= low || value >= high) {
      result.warnings.push_back(fmt::format(
          "{} = {:.4g} {} lies at the edge of its range {:.4g}..{:.4g} or outside: these data do "
          "not identify it",
          parameter.name, value, parameter.unit, parameter.range->minimum,
          parameter.range->maximum));
    }
  }
  result.covariance = work.covariance(reported, reported);
}

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
  if (table.run().values.size() > 1) {
    add(fmt::format("{} {}", table.run_word(), table.run().at(row)));
  }
  return fmt::format("Row {}{}{}", row + 1, where, where.empty() ? "" : ")");
}

/// Single rows that the rest of them contradicts.
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

/// What an unknown lag of the thermometer may do is added to the covariance, and said where that
/// matters. Precondition: coloured noise.
void allow_for_lag(FitWork& work) {
  if (!may_read_late(work.table, work.signals)) return;
  FitWork now = work;
  now.result.warnings.clear();
  fill_residuals(now);
  fill_estimates(now);
  const auto rise =
      rise_in_a_second(work.table, work.signals, fitted_model(work.model, work.design, now.result),
                       work.observations);
  const auto whitener = make_whitener(work.observations.windows(), work.result.noise.noise);
  if (!rise || !whitener) return;
  const Eigen::MatrixXd x =
      linearise(work, work.observations.window_rows(work.inner, work.inner.size() > 0)).x;
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    if (std::isfinite(work.covariance(i, i))) known.push_back(i);
  }
  const Eigen::VectorXd moved = kUsualLag_s * (*whitener)
                                                  ->whiten(x(Eigen::all, known))
                                                  .colPivHouseholderQr()
                                                  .solve((*whitener)->whiten(*rise).col(0));
  std::vector<std::string> wider;
  const std::vector<Eigen::Index> free = work.design.free_columns();
  for (std::size_t k = 0; k < known.size(); ++k) {
    const double before = work.covariance(known[k], known[k]);
    const double added = moved[static_cast<Eigen::Index>(k)] * moved[static_cast<Eigen::Index>(k)];
    if (known[k] >= work.free() || std::sqrt(1.0 + added / before) < 1.0 + kWorthSaying) continue;
    const DesignColumn& column =
        work.design.columns()[static_cast<std::size_t>(free[static_cast<std::size_t>(known[k])])];
    if (!column.start) wider.push_back(column.name);
  }
  work.covariance(known, known) += moved * moved.transpose();
  if (wider.empty()) return;
  work.result.warnings.push_back(
      fmt::format("the table does not say that its temperatures are freed of their sensor's lag "
                  "(temperature_start_c): a usual lag of {:.0f} s is part of the uncertainty of {}",
                  kUsualLag_s, fmt::join(wider, ", ")));
}

/// Given coefficients held against the data. The noise is what a free fit of the same terms leaves,
/// where one is possible.
Result<FitResult> hold(FitWork work) {
  for (const DesignColumn& column : work.design.columns()) {
    if (column.held || column.start) continue;
    return Error{ErrorCode::kBadInput, fmt::format("term {}: has no coefficient, expected one to "
                                                   "hold against the data",
                                                   column.name)};
  }
  work.inner.resize(static_cast<Eigen::Index>(work.design.parameters().size()));
  for (Eigen::Index i = 0; i < work.inner.size(); ++i) {
    const DesignParameter& parameter = work.design.parameters()[static_cast<std::size_t>(i)];
    if (!parameter.start) {
      return Error{
          ErrorCode::kBadInput,
          fmt::format("{}: has no value, expected one to hold against the data", parameter.name)};
    }
    work.inner[i] = *parameter.start;
  }
  FitResult& result = work.result;
  result.degrees_of_freedom = static_cast<double>(work.observations.taken().size());
  // How the memories began is the data's, not the model's: it is found here as in any fit.
  if (work.free() > 0) {
    const std::optional<LinearFit> starts = linear_fit_at(work.observations, work.inner);
    if (!starts) return not_finite_at(work.observations, work.inner);
    work.beta = starts->beta;
    result.degrees_of_freedom -= static_cast<double>(starts->kept.size());
  }
  fill_residuals(work);
  FitOptions free_options = work.options;
  free_options.as_is = false;
  free_options.doubt_rows = false;  // its noise is wanted on the same rows
  const Result<FitResult> free = fit(work.table, work.model, free_options);
  if (free && free->degrees_of_freedom > 0.0) {
    result.noise = free->noise;
    result.coloured = free->coloured;
    result.standard_deviation = free->standard_deviation;
    result.whitened = result.residual.cwiseQuotient(result.standard_deviation);
    if (result.coloured && work.observations.use_windows(kMostFittedWindows)) {
      if (Status noise = fill_coloured_noise(work); !noise) return noise.error();
    }
  } else {
    fill_independent_noise(work);
  }
  for (std::size_t i = 0; i < work.design.own_columns(); ++i) {
    const DesignColumn& column = work.design.columns()[i];
    result.estimates.push_back({column.name, column.unit, *column.given, 0.0, 2.0, true});
  }
  for (std::size_t i = 0; i < work.design.parameters().size(); ++i) {
    const DesignParameter& parameter = work.design.parameters()[i];
    result.estimates.push_back({parameter.name, parameter.unit,
                                work.inner[static_cast<Eigen::Index>(i)], 0.0, 2.0, true, true});
  }
  result.fitted = work.model;
  return std::move(result);
}

/// The fit anew, without these rows.
Result<FitResult> fit_without(const FitWork& work, std::vector<LeftOut> bad) {
  FitOptions options = work.options;
  options.doubt_rows = false;
  for (const LeftOut& row : bad) options.leave_out.push_back(row.row);
  auto again = fit(work.table, work.model, options);
  if (!again) return again;
  for (const LeftOut& row : bad) again->warnings.push_back(row.says);
  again->left_out = std::move(bad);
  return again;
}

}  // namespace

double coverage_factor(double degrees_of_freedom) {
  if (!(degrees_of_freedom > 0.0)) return kMissing;
  const boost::math::students_t distribution(degrees_of_freedom);
  return boost::math::quantile(distribution, (1.0 + kCoverage) / 2.0);
}

Table without_readings(Table table, const std::string& observable,
                       const std::vector<LeftOut>& left_out) {
  const auto given = table.column(observable);
  std::vector<double> values(given.begin(), given.end());
  for (const LeftOut& row : left_out) values[row.row] = kMissing;
  table.set_column(observable, std::move(values));
  return table;
}

Result<FitResult> fit(const Table& table, const config::ModelFile& model,
                      const FitOptions& options) {
  const Signals signals(table, model.reference_temperature_c);
  Result<Design> design = Design::make(signals, model, options.as_is);
  if (!design) return design.error();
  Result<Observations> observations =
      Observations::make(signals, *design, model.observable, options.weight_by, options.leave_out);
  if (!observations) return observations.error();
  FitWork work{table, model, options, signals, *design, *observations, {}, {}, {}, {}, {}, 2.0};
  if (options.as_is) return hold(std::move(work));

  work.inner.resize(static_cast<Eigen::Index>(design->parameters().size()));
  if (static_cast<Eigen::Index>(observations->taken().size()) < work.unknowns()) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("found {} usable rows, expected at least {}, one for each unknown",
                             observations->taken().size(), work.unknowns())};
  }
  Result<bool> coloured = choose_coloured(work);
  if (!coloured) return coloured.error();
  if (Status fitted = fit_independent(work); !fitted) return fitted.error();
  if (*coloured) {
    if (Status fitted = fit_coloured(work); !fitted) return fitted.error();
  }
  if (options.doubt_rows) {
    std::vector<LeftOut> bad = find_left_out(work);
    if (!bad.empty()) return fit_without(work, std::move(bad));
  }
  if (*coloured && options.doubt_lag) allow_for_lag(work);
  fill_residuals(work);
  if (*coloured) {
    if (Status noise = fill_coloured_noise(work); !noise) return noise.error();
  } else {
    fill_independent_noise(work);
  }
  fill_estimates(work);
  const std::vector<UnexcitedTerm> unexcited =
      unexcited_terms(signals, model, *design, work.result.estimates);
  if (!unexcited.empty() && unexcited.size() < model.terms.size()) {
    auto rest = fit(table, without_terms(model, unexcited), options);
    if (!rest) return rest;
    return with_unexcited(std::move(*rest), unexcited, *design, work.result.estimates);
  }
  warn_of_calendar(work);
  for (std::string& warning : weak_evidence(work.result)) {
    work.result.warnings.push_back(std::move(warning));
  }
  work.result.fitted = fitted_model(model, *design, work.result);
  return std::move(work.result);
}

}  // namespace fogbench::model
