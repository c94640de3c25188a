#include "model/diagnose/diagnose.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "model/design.hpp"
#include "model/diagnose/bins.hpp"
#include "model/diagnose/calibration.hpp"
#include "model/diagnose/heldout.hpp"
#include "model/diagnose/next_measurement.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kAdequacyLevel = 0.01;  // of the check with smooth functions
constexpr Index kAdequacyDraws = 499;
// A verdict needs rows beyond the terms: with fewer nothing can be said of noise or structure.
constexpr std::size_t kFewestFreeRows = 4;

/// The model's columns at its fitted inner parameters (their tangents included), and the observable
/// less the terms that are held.
struct Base {
  MatrixXd columns;
  VectorXd y;
};

Result<Base> base_of(const Signals& signals, const config::ModelFile& fitted) {
  config::ModelFile free = fitted;
  for (config::ModelTerm& term : free.terms) {
    if (term.fixed) continue;
    term.coefficient.reset();
    term.coefficients.clear();
  }
  const auto design = Design::make(signals, free, false);
  if (!design) return design.error();
  VectorXd inner(static_cast<Index>(design->parameters().size()));
  for (Index i = 0; i < inner.size(); ++i) {
    inner[i] = design->parameters()[static_cast<std::size_t>(i)].start.value_or(1.0);
  }
  Base base;
  design->visit(inner, true, signals.signal(fitted.observable),
                [&](std::size_t begin, Eigen::Ref<MatrixXd> rows) {
                  if (base.columns.size() == 0) {
                    base.columns.resize(static_cast<Index>(signals.rows()), rows.cols() - 1);
                    base.y.resize(static_cast<Index>(signals.rows()));
                  }
                  const auto at = static_cast<Index>(begin);
                  base.columns.middleRows(at, rows.rows()) = rows.leftCols(rows.cols() - 1);
                  base.y.segment(at, rows.rows()) = rows.rightCols(1);
                });
  base.columns = full_rank(base.columns);
  return base;
}

Windows windows_of(const Signals& signals) {
  Windows windows;
  for (const Signals::RunRange& run : signals.runs()) windows.run_begin.push_back(run.begin);
  windows.run_begin.push_back(signals.rows());
  const auto n = static_cast<Index>(signals.rows());
  const bool timed = signals.available("time_s");
  windows.centre_s = timed ? VectorXd(signals.signal("time_s")) : VectorXd(n);
  windows.duration_s = VectorXd::Ones(n);
  windows.white_floor = VectorXd::Zero(n);
  if (signals.available("rate_std_error_deg_per_h")) {
    windows.white_floor = signals.signal("rate_std_error_deg_per_h");
  }
  for (const Signals::RunRange& run : signals.runs()) {
    for (std::size_t i = run.begin; i < run.end; ++i) {
      const auto k = static_cast<Index>(i);
      if (!timed) windows.centre_s[k] = static_cast<double>(i - run.begin) * 1e6;
    }
  }
  if (signals.available("duration_s")) {
    const auto duration = signals.signal("duration_s");
    if (duration.minCoeff() > 0.0) windows.duration_s = duration;
  }
  return windows;
}

config::ModelFile extended_by(config::ModelFile model, const std::vector<Found>& found) {
  for (config::ModelTerm& term : model.terms) {
    if (term.fixed) continue;
    term.coefficient.reset();
    term.coefficients.clear();
    term.standard_errors.clear();
  }
  model.fit.reset();
  for (const Found& f : found) {
    config::ModelTerm term;
    term.effect = std::string(f.effect->info().id);
    for (std::size_t i = 0; i < f.inner.size(); ++i) {
      term.parameters[std::string(f.effect->info().parameters[i].name)] = f.inner[i];
    }
    model.terms.push_back(std::move(term));
  }
  return model;
}

/// Does anything smooth in any variable remain? Calibrated on the noise of the last fit.
struct Adequacy {
  double p_value = 1.0;
  std::vector<std::string> depends_on;
};

Adequacy check_adequacy(const Signals& signals, const NoiseShapes& shapes, const MatrixXd& base,
                        const VectorXd& y, std::uint64_t seed) {
  Adequacy out;
  if (base.rows() <= base.cols() + static_cast<Index>(kFewestFreeRows)) return out;
  const Library smooth = make_smooth_library(signals);
  if (smooth.candidates.empty()) return out;
  const Detector detector(shapes, base, smooth, y);
  const Draws draws = detector.draw(kAdequacyDraws, seed);
  const Calibration calibration(detector.lambdas_at_null_noise(draws));
  const VectorXd lead = calibration.lead(detector.observed_at_null_noise());
  std::vector<std::pair<double, std::string>> ranked;
  std::vector<Index> all;
  for (Index c = 0; c < lead.size(); ++c) {
    if (!detector.testable(c)) continue;
    all.push_back(c);
    ranked.emplace_back(-lead[c], smooth.candidates[static_cast<std::size_t>(c)].name);
  }
  if (all.empty()) return out;
  std::sort(ranked.begin(), ranked.end());
  out.p_value = calibration.p_value(-ranked.front().first, all);
  constexpr std::size_t kMostNames = 3;
  for (const auto& [lag, name] : ranked) {
    if (lag < 0.0 && out.depends_on.size() < kMostNames) out.depends_on.push_back(name);
  }
  return out;
}

std::string strength(double p) {
  return p < 1e-4 ? fmt::format("p = {:.0e}", p) : fmt::format("p = {:.2g}", p);
}

void say(Diagnosis& d) {
  auto& out = d.sentences;
  switch (d.verdict) {
    case Verdict::kAdequate:
      out.push_back(fmt::format("Nothing is missing that these data can show ({}): what is left, "
                                "{:.3g} deg/h RMS, is noise.",
                                strength(d.p_adequate), d.comparison.fit.rms));
      break;
    case Verdict::kMissingEffect: {
      std::vector<std::string> names;
      for (const MissingEffect& m : d.missing) names.emplace_back(m.found.effect->info().id);
      out.push_back(fmt::format("Missing: {} ({}).", fmt::join(names, ", "), strength(d.p_adequate)));
      break;
    }
    case Verdict::kAmbiguous:
      out.push_back(fmt::format("Something is missing ({}), and these data cannot say which of "
                                "several effects it is.",
                                strength(d.p_adequate)));
      break;
    case Verdict::kUnexplained:
      out.push_back(fmt::format("Something is left that no effect of the catalogue explains ({}); "
                                "it depends on {}.",
                                strength(d.unexplained.p_value),
                                d.unexplained.depends_on.empty()
                                    ? std::string("nothing that the table holds")
                                    : fmt::format("{}", fmt::join(d.unexplained.depends_on, ", "))));
      break;
  }
  for (const MissingEffect& m : d.missing) {
    std::string line = fmt::format("{}: ", m.found.effect->info().id);
    for (std::size_t i = 0; i < m.estimates.size(); ++i) {
      const Estimate& e = m.estimates[i];
      line += fmt::format("{}{} = {:.4g} +- {:.2g} {}", i > 0 ? ", " : "", e.name, e.value,
                          e.coverage_factor * e.standard_error, e.unit);
    }
    line += fmt::format("; {}, RMS falls to {:.3g} deg/h", strength(m.found.p_value), m.rms_after);
    if (m.found.inner_at_edge) {
      line += "; its inner parameter lies on the edge of the range and is not identified";
    }
    if (!m.found.or_shape.empty()) {
      line += fmt::format("; or another effect of this shape ({})", m.found.or_shape);
    }
    out.push_back(line + ".");
  }
  for (const auto& set : d.ambiguous) {
    out.push_back(fmt::format("Cannot tell apart: {}.", fmt::join(set, ", ")));
  }
}

}  // namespace

Result<Diagnosis> diagnose(const Table& input, const config::ModelFile& model,
                           const DiagnoseOptions& options) {
  const auto binned = table_for_diagnosis(input, model, options.quiet);
  if (!binned) return binned.error();
  const Table& table = binned->table;

  Diagnosis d;
  d.false_alarm_rate = options.false_alarm_rate;
  config::ModelFile own = extended_by(model, {});
  if (binned->has_quiet_run) own.terms.push_back(quiet_bias());
  auto comparison = compare(table, own, {}, options.seed);
  if (!comparison) return comparison.error();
  d.comparison = std::move(*comparison);

  const Signals signals(table, model.reference_temperature_c);
  auto base = base_of(signals, d.comparison.fit.fitted);
  if (!base) return base.error();
  const auto shapes = NoiseShapes::make(windows_of(signals));
  if (!shapes) return shapes.error();

  const SearchInput problem{signals, *shapes, own, base->columns, base->y};
  SearchOptions search_options;
  search_options.false_alarm_rate = options.false_alarm_rate;
  search_options.seed = options.seed;
  SearchResult found;
  if (signals.rows() >= static_cast<std::size_t>(base->columns.cols()) + kFewestFreeRows) {
    found = search(problem, search_options);
  }
  d.not_testable = found.not_testable;
  d.bounds = found.bounds;
  if (!found.p_of_step.empty()) d.p_adequate = found.p_of_step.front();

  // The ladder: refit and predict held-out blocks with one effect more each time.
  d.heldout_rms = heldout_rms(table, d.comparison.fit.fitted, d.comparison.fit.noise.noise);
  d.ladder.push_back({"", d.comparison.fit.rms, d.heldout_rms});
  d.extended = d.comparison.fit.fitted;
  d.noise = d.comparison.fit.noise.noise;
  d.noise_floor = d.comparison.noise_floor;
  std::vector<Found> so_far;
  for (const Found& f : found.found) {
    so_far.push_back(f);
    MissingEffect missing{.found = f, .estimates = {}};
    const auto refit = compare(table, extended_by(own, so_far), {}, options.seed);
    if (refit) {
      const std::string id(f.effect->info().id);
      for (const Estimate& e : refit->fit.estimates) {
        if (e.name == id || e.name.starts_with(id + ".")) missing.estimates.push_back(e);
      }
      missing.rms_after = refit->fit.rms;
      missing.heldout_rms_after = heldout_rms(table, refit->fit.fitted, refit->fit.noise.noise);
      d.extended = refit->fit.fitted;
      d.noise = refit->fit.noise.noise;
      d.noise_floor = refit->noise_floor;
      d.ladder.push_back({id, missing.rms_after, missing.heldout_rms_after});
    }
    if (!f.rivals.empty()) {
      std::vector<std::string> set{std::string(f.effect->info().id)};
      for (const Rival& r : f.rivals) set.push_back(r.effect);
      d.ambiguous.push_back(std::move(set));
    }
    d.missing.push_back(std::move(missing));
  }

  MatrixXd last = base->columns;
  for (const Found& f : found.found) {
    const MatrixXd more = columns_of(f, signals);
    MatrixXd wider(last.rows(), last.cols() + more.cols());
    wider << last, more;
    last = std::move(wider);
  }
  const Adequacy adequacy =
      check_adequacy(signals, *shapes, full_rank(last), base->y, options.seed + 77);
  d.unexplained.p_value = adequacy.p_value;
  if (adequacy.p_value <= kAdequacyLevel) d.unexplained.depends_on = adequacy.depends_on;
  if (!found.outside_shape.empty()) {
    d.unexplained.p_value = std::min(d.unexplained.p_value, found.p_outside);
    d.unexplained.suggestion = found.outside_shape;
  }

  if (adequacy.p_value <= kAdequacyLevel || !found.outside_shape.empty()) {
    d.verdict = Verdict::kUnexplained;
    d.p_adequate = std::min(d.p_adequate, d.unexplained.p_value);
  } else if (!d.ambiguous.empty()) {
    d.verdict = Verdict::kAmbiguous;
  } else if (!d.missing.empty()) {
    d.verdict = Verdict::kMissingEffect;
  }
  d.next_measurements = next_measurements(d.ambiguous, d.not_testable);
  say(d);
  return d;
}

}  // namespace fogbench::model
