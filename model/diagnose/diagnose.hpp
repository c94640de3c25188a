#pragma once
// What is missing in an error model, how sure that is, or that nothing is: the whole diagnosis.
//
//   fit the model -> is what is left more than noise? -> which effect explains it (search.hpp)
//   -> is what is then left noise? (smooth functions of every variable: adequacy.hpp)
//   -> adequate | missing_effect | ambiguous | unexplained

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "config/model_file.hpp"
#include "config/result.hpp"
#include "model/compare/compare.hpp"
#include "model/diagnose/loop_figures.hpp"
#include "model/diagnose/search.hpp"
#include "model/next/next_measurement.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

enum class Verdict { kNothingMissing, kMissingEffect, kAmbiguous, kUnexplained };

/// "adequate", "missing_effect", "ambiguous", "unexplained".
std::string_view name_of(Verdict verdict);

struct Diagnosis;
/// The same, or "cannot_tell" where the rows do not suffice for a verdict.
std::string_view verdict_of(const Diagnosis& diagnosis);
/// Nothing is missing, as far as the data can show; false where they can show nothing.
bool found_adequate(const Diagnosis& diagnosis);

struct MissingEffect {
  Found found;
  std::vector<std::string>
      terms;  ///< what it adds to the model: itself, but for changes between runs and loops
  std::vector<Estimate> estimates;  ///< its coefficients and inner parameters, after the last refit
  /// The data do not say what its inner parameters are (standard error NaN); the coefficients'
  /// uncertainties are those at the values that fit best.
  bool inner_open = false;
  std::optional<LoopFigures> loop;  ///< of a hysteresis
  double rms_after = 0.0;
  double heldout_rms_after = 0.0;
};

struct LadderStep {
  std::string added;  ///< empty: the model as it came
  double rms = 0.0;
  double heldout_rms = 0.0;
};

/// Structure that no effect of the catalogue explains.
struct Unexplained {
  double p_value = 1.0;
  std::vector<std::string> depends_on;
  std::string shape;  ///< in words: what resembles it more than any effect does; empty: none
  /// An expression to start from, a guess: a term of a model file; empty: none was any good.
  std::string suggestion;
  bool beside_found = false;  ///< the suggestion stands beside the effects that were found
  double heldout_rms = std::numeric_limits<double>::quiet_NaN();  ///< with the suggestion
};

struct Diagnosis {
  Verdict verdict = Verdict::kNothingMissing;
  double p_adequate = 1.0;  ///< of the model as it came
  bool judged = true;       ///< false: too few rows beside the terms to tell anything
  double false_alarm_rate = 0.05;
  Table table;  ///< what was analysed: complete rows, binned where there were many
  std::size_t rows_per_bin = 1;
  std::vector<LeftOut> left_out;  ///< single bad readings of the table that was given
  Comparison before;              ///< the model as it came, on `table`: fit and failing regions
  FitResult after;                ///< with the missing effects, on `table`; as before.fit if none
  double heldout_rms = 0.0;       ///< of the model as it came
  /// RMS residual that noise alone leaves beside the last fit, the same on every step of the
  /// ladder; NaN: unknown.
  double noise_floor = std::numeric_limits<double>::quiet_NaN();
  NoiseFloor floor;         ///< its parts
  NoiseCoefficients noise;  ///< estimated with the last fit
  /// K over what such instruments show at most, where a random walk of that size would explain
  /// everything that was found; 0: none would.
  double walk_beyond = 0.0;
  NoisePrior::Source noise_source = NoisePrior::Source::kInstruments;
  std::vector<MissingEffect> missing;
  std::vector<Found> refused;   ///< led, and cannot be named: Found::refusal says why
  bool far_from_floor = false;  ///< rows left out are missed by much more than noise makes
  std::vector<std::vector<std::string>> ambiguous;
  Unexplained unexplained;
  std::vector<NotTestable> not_testable;
  std::vector<Bound> bounds;
  std::vector<NextMeasurement> next_measurements;
  std::vector<LadderStep> ladder;
  /// "the thermometer's resolution of 1 degC", where it explains what an effect would have been
  /// named for; empty: it does not.
  std::string explained_by_thermometer;
  /// How the table was taken where it was not as it should be, in sentences.
  std::vector<std::string> notes;
};

struct DiagnoseOptions {
  double false_alarm_rate = 0.05;
  const Table* quiet = nullptr;  ///< a static record of the same gyro: informs the noise only
  NoisePrior prior = {};         ///< of the gyro's noise
  /// Terms of the user that take part as candidates beside the catalogue (expressions, or
  /// catalogue effects with starting values).
  std::vector<config::ModelTerm> candidates;
  BenchReach reach = {};  ///< of the bench that would do what is proposed
  std::uint64_t seed = 20260101;
  /// Called with a few words as each part of the work begins, and the share done (0 ... 1).
  std::function<void(const std::string& part, double share)> progress;
};

/// Errors: those of fit() for the model as it came.
Result<Diagnosis> diagnose(const Table& table, const config::ModelFile& model,
                           const DiagnoseOptions& options);

}  // namespace fogbench::model
