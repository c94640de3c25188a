#pragma once
// Where a fitted (or held) model misses its measurements: mean residual per segment, run and range
// of each variable, with its significance under the noise, worst first, each in a plain sentence
// with units; and what changed between runs (test 1, test 2).
//
//   mean residual of region g:  m_g = w_g'r
//   cov(m) = W'(Omega - X (X'Omega^-1 X)^-1 X')W     (fitted; averaged over the plausible noise)
//   cov(m) = W'Omega W                               (held: nothing was fitted away)
//   p of the worst region: the share of draws of the noise whose largest |z| is at least its own
//
// A misfit need not move the mean of any range: a loop, a lag. So a fitted model is also held
// against every effect of the catalogue, as a diagnosis does first (diagnose/first_look.hpp): what
// that names is never called noise here.
//
// z is m_g over its standard error; under coloured noise on up to 1,000 windows it is the offset's
// own likelihood ratio (region_score.hpp), which sees more. With independent noise of unknown size
// the draws are divided by their own residual deviation.

#include <cstdint>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "model/fit/fit.hpp"
#include "model/noise/plausible_noise.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

struct Region {
  std::string where;     ///< "segment coil_z/down", "run 2", or empty
  std::string variable;  ///< column name, or empty
  double from = 0.0, to = 0.0;
  std::size_t rows = 0;
  double observed = 0.0;  ///< means over the region's rows
  double residual = 0.0;  ///< observed - model
  /// What z is about: the residual, or under coloured noise the offset from the rows around it that
  /// is left when slow drift is allowed for.
  double offset = 0.0;
  bool drift_allowed = false;
  double standard_error = 0.0;  ///< of that mean under the noise; 0 when it is not known
  double z = 0.0;
  double p_family_wise = 1.0;  ///< corrected for all regions looked at
  std::string says;
};

/// Where a region lies, for a table: "55 degC", "field z of 100 uT", "segment coil_z/down".
std::string place_of(const Region& region);

/// Two runs' coefficients against each other.
struct RunChange {
  std::string run_a, run_b;
  double common_scale = 1.0;  ///< b = scale * a, weighted least squares over the magnetic terms
  double scale_standard_error = 0.0;
  double angle_deg = 0.0;  ///< between the two coefficient vectors
  double p_repeat = 1.0;   ///< that both runs measured the same coefficients
  bool scale_changed = false;
  std::string says;
};

struct Comparison {
  FitResult fit;
  bool as_is = false;
  std::vector<Region> regions;  ///< worst first
  std::vector<RunChange> changes;
  /// The conclusions, in the order to print them: the verdict, what carries it, then the rest.
  std::vector<std::string> sentences;
  bool noise_known = false;  ///< from the table or the fit; else z and p mean nothing
  /// RMS that noise alone would leave, beside that of the fit (NoiseFloor::beside); where the model
  /// fails, its white part, which no misfit can pass for; NaN: unknown.
  double noise_floor = 0.0;
  NoiseFloor floor;  ///< its parts, where they are known
  /// Chance that noise alone makes some range, or the lead of some effect, stand out as much.
  double p_adequate = 1.0;
  std::string looks_like;  ///< the effect or shape that stands out, where one does
};

/// The model is adequate unless p_adequate is below this.
inline constexpr double kAdequate = 0.05;

/// Whether a fitted model is also held against every effect (the first step of a diagnosis): a
/// diagnosis that takes that step itself does not ask for it.
enum class LookForEffects { kYes, kNo };

/// `seed` of the draws behind p_family_wise. Errors: those of fit().
Result<Comparison> compare(const Table& table, const config::ModelFile& model,
                           const FitOptions& options, std::uint64_t seed = 1,
                           LookForEffects look = LookForEffects::kYes);

}  // namespace fogbench::model
