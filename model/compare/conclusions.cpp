#include "model/compare/conclusions.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "config/rounding.hpp"
#include "config/units.hpp"
#include "model/compare/partition.hpp"
#include "model/compare/repeatability.hpp"
#include "model/effects/catalogue.hpp"
#include "model/fit/predict.hpp"

namespace fogbench::model {
namespace {

constexpr std::size_t kMostRunsCompared = 6;

/// Half a unit in the last digit that the number is written with: 0.004 -> 0.0005.
double half_last_digit(double value) {
  const std::string text = fmt::format("{}", value);
  const std::size_t exponent = text.find('e');
  const std::string digits = text.substr(0, exponent);
  const std::size_t point = digits.find('.');
  const auto decimals =
      point == std::string::npos ? 0 : static_cast<int>(digits.size() - point - 1);
  const int power = exponent == std::string::npos ? 0 : std::stoi(text.substr(exponent + 1));
  return 0.5 * std::pow(10.0, power - decimals);
}

struct Rounding {
  std::string name;
  double given = 0.0, half = 0.0;
  double effect = 0.0;  ///< on the model's mean over the region
};

/// What half a last digit of each given coefficient does to the model in a region.
std::vector<Rounding> rounding_in(const Region& region, const Table& table,
                                  const config::ModelFile& model, const FitResult& fit) {
  std::vector<Rounding> out;
  for (std::size_t t = 0; t < model.terms.size(); ++t) {
    if (!model.terms[t].coefficient) continue;
    config::ModelFile moved = model;
    const double given = *model.terms[t].coefficient;
    const double half = half_last_digit(given);
    *moved.terms[t].coefficient = given + half;
    const auto values = predict(table, moved);
    if (!values) continue;
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 0; i < fit.rows.size(); ++i) {
      if (!region.variable.empty()) {
        if (!table.has(region.variable)) continue;
        const double at = table.column(region.variable)[fit.rows[i]];
        if (!(at >= region.from && at <= region.to)) continue;
      }
      sum += (*values)[static_cast<Eigen::Index>(fit.rows[i])] -
             fit.predicted[static_cast<Eigen::Index>(i)];
      count += 1.0;
    }
    if (count > 0.0) out.push_back({model.terms[t].effect, given, half, std::abs(sum / count)});
  }
  std::sort(out.begin(), out.end(),
            [](const Rounding& a, const Rounding& b) { return a.effect > b.effect; });
  return out;
}

void say_rounding(Comparison& comparison, const Table& table, const config::ModelFile& model,
                  std::string_view unit) {
  const Region& worst = comparison.regions.front();
  const std::vector<Rounding> all = rounding_in(worst, table, model, comparison.fit);
  double sum = 0.0;
  for (const Rounding& rounding : all) sum += rounding.effect;
  if (all.empty() || sum < std::abs(worst.residual)) return;
  const Rounding& first = all.front();
  comparison.sentences.push_back(fmt::format(
      "Rounding alone could explain that miss: half a unit in the last digit of {} ({} +- {}) "
      "moves "
      "the model there by {:.2f} {}, all the given digits together by {:.2f} {}. Give more digits, "
      "or fit them.",
      first.name, first.given, first.half, first.effect, unit, sum, unit));
}

std::string verdict_of_compare(const Comparison& c) {
  if (!c.noise_known) return "Whether the model misses by more than noise cannot be said.";
  if (c.p_adequate < kAdequate) {
    return fmt::format(
        "The model misses the measurements by more than noise explains ({}){}.",
        probability_text(c.p_adequate),
        c.looks_like.empty() ? std::string() : ": what is left looks like " + c.looks_like);
  }
  if (c.regions.empty()) return "All rows are alike: there are no ranges to look at one by one.";
  if (c.regions.front().z == 0.0) {
    return "The fitted terms leave no range free to differ from the measurements on average.";
  }
  return fmt::format("The model misses the measurements by no more than noise explains ({}).",
                     probability_text(c.p_adequate));
}

std::string evidence_of_compare(const Comparison& c, std::string_view unit) {
  std::string text = fmt::format("{} leaves an RMS residual of {} {} over {} rows",
                                 c.as_is ? "The model, held as given," : "The fitted model",
                                 config::significant(c.fit.rms, 3), unit, c.fit.rows.size());
  if (!std::isfinite(c.noise_floor)) return text + ".";
  const bool fails = c.p_adequate < kAdequate;
  const std::string_view which = !c.fit.coloured ? "the stated noise"
                                 : fails         ? "white noise"
                                                 : "noise";
  return text + fmt::format(", where {} alone would leave {}.", which,
                            config::significant(c.noise_floor, 3));
}

void say_noise(Comparison& c, std::string_view unit, const std::string& noise_says) {
  const bool fails = c.noise_known && c.p_adequate < kAdequate;
  std::string text = fmt::format("The noise: {}.", noise_says);
  if (std::isfinite(c.noise_floor) && c.fit.coloured && !fails) {
    text += fmt::format(" What it leaves: {}.", c.floor.parts_in_words(unit));
  }
  if (fails && c.fit.coloured && !c.as_is) {
    text += " Part of the model's misfit may stand in these numbers.";
  }
  c.sentences.push_back(std::move(text));
}

/// The worst range; the others stand in the table beside it.
void say_worst_range(Comparison& c, const Table& table, const config::ModelFile& model,
                     std::string_view unit) {
  const bool fails = c.noise_known && c.p_adequate < kAdequate;
  if (c.regions.empty() || (c.noise_known && c.regions.front().z == 0.0)) return;
  const Region& worst = c.regions.front();
  if (fails && worst.p_family_wise >= kAdequate) return;
  c.sentences.push_back(worst.says);
  c.sentences.push_back(
      fmt::format("It is the worst of {}; the model gives {}, the measurements {} {}.",
                  c.regions.size(), config::significant(worst.observed - worst.residual, 4),
                  config::significant(worst.observed, 4), unit));
  if (c.as_is && (fails || !c.noise_known)) say_rounding(c, table, model, unit);
}

/// One run's fit.
struct RunFit {
  std::string run;
  FitResult fit;
  std::string word;  ///< what `run` is: "run" or "test"
};

std::vector<RunFit> fit_each_run(const Table& table, const config::ModelFile& model,
                                 const FitOptions& options) {
  std::vector<RunFit> out;
  const TextColumn& runs = table.run();
  for (std::uint32_t r = 0; r < runs.values.size() && out.size() < kMostRunsCompared; ++r) {
    std::vector<bool> keep(table.rows());
    for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = runs.index[i] == r;
    auto fitted = fit(table.select(keep), model, options);
    if (fitted) out.push_back({runs.values[r], std::move(*fitted), table.run_word()});
  }
  return out;
}

/// The magnetic coefficients of a run, with their covariance where it is known.
RunCoefficients magnetic_part(const RunFit& run, std::vector<std::string>& names,
                              std::string& unit) {
  std::vector<Eigen::Index> chosen;
  std::vector<double> values;
  names.clear();
  Eigen::Index k = 0;
  for (const Estimate& estimate : run.fit.estimates) {
    if (estimate.held) continue;
    if (is_field_sensitivity(estimate.name) && std::isfinite(estimate.value)) {
      chosen.push_back(k);
      values.push_back(estimate.value);
      names.push_back(estimate.name);
      unit = estimate.unit;
    }
    ++k;
  }
  RunCoefficients out{.run = run.run, .values = {}, .covariance = {}, .word = run.word};
  out.values =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  const Eigen::MatrixXd covariance = run.fit.covariance(chosen, chosen);
  if (covariance.allFinite()) out.covariance = covariance;
  return out;
}

/// Coefficients other than the magnetic ones, where both runs know their uncertainty.
void say_differences(std::vector<std::string>& out, const std::vector<RunFit>& runs) {
  for (std::size_t r = 1; r < runs.size(); ++r) {
    for (std::size_t k = 0; k < runs[0].fit.estimates.size(); ++k) {
      const Estimate& a = runs[0].fit.estimates[k];
      const auto& others = runs[r].fit.estimates;
      if (k >= others.size() || others[k].name != a.name || a.held) continue;
      if (is_field_sensitivity(a.name)) continue;
      const Estimate& b = others[k];
      const double expanded =
          std::hypot(a.coverage_factor * a.standard_error, b.coverage_factor * b.standard_error);
      if (!(std::abs(b.value - a.value) > expanded)) continue;
      out.push_back(fmt::format(
          "From {0} {1} to {0} {2} {3} changed by {4:.3g} +- {5:.2g} {6} (95 %), from {7:.3g} to "
          "{8:.3g}.",
          runs[0].word, runs[0].run, runs[r].run, a.name, b.value - a.value, expanded, a.unit,
          a.value, b.value));
    }
  }
}

/// Fills `changes`; the sentences about them.
std::vector<std::string> find_changes(Comparison& c, const Table& table,
                                      const config::ModelFile& model, const FitOptions& options) {
  std::vector<std::string> out;
  if (table.run().values.size() < 2 || options.as_is) return out;
  const std::vector<RunFit> runs = fit_each_run(table, model, options);
  if (runs.size() < 2) return out;
  std::vector<RunCoefficients> sets;
  std::vector<std::string> names, first_names;
  std::string unit;
  bool comparable = true;
  for (const RunFit& run : runs) {
    sets.push_back(magnetic_part(run, names, unit));
    if (sets.size() == 1) first_names = names;
    comparable = comparable && names == first_names && names.size() >= 2;
  }
  if (comparable) {
    const bool noise_known = std::all_of(sets.begin(), sets.end(),
                                         [](const auto& set) { return set.covariance.size() > 0; });
    bool scale_changed = false;
    for (auto& set : sets) {
      if (!noise_known) set.covariance.resize(0, 0);
    }
    for (std::size_t r = 1; r < sets.size(); ++r) {
      c.changes.push_back(change_between(sets[0], sets[r], names, unit));
      scale_changed = scale_changed || c.changes.back().scale_changed;
    }
    if (!noise_known && !scale_changed) {
      for (std::string& text : judge_by_scatter(sets, names, unit)) {
        out.push_back(std::move(text));
      }
    }
    for (const RunChange& change : c.changes) out.push_back(change.says);
  }
  say_differences(out, runs);
  return out;
}

}  // namespace

std::string probability_text(double p) {
  return p < 1e-4 ? "p < 0.0001" : fmt::format("p = {:.2g}", p);
}

void conclude(Comparison& comparison, const Table& table, const config::ModelFile& model,
              const FitOptions& options, const std::string& noise_says) {
  const std::string_view unit = config::unit_of(model.observable);
  std::vector<std::string> changes = find_changes(comparison, table, model, options);
  comparison.sentences = {verdict_of_compare(comparison), evidence_of_compare(comparison, unit)};
  say_noise(comparison, unit, noise_says);
  say_worst_range(comparison, table, model, unit);
  for (std::string& text : changes) comparison.sentences.push_back(std::move(text));
}

}  // namespace fogbench::model
