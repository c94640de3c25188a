#pragma once
// The stretch of a run that is fit for an Allan deviation: the longest one in which nothing was
// done to the gyro (no heating, no sweep, temperature at rest), taken from the raw stream.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "model/noise/allan.hpp"
#include "procedures/recorder.hpp"
#include "record/run_log_reader.hpp"

namespace fogbench::acceptance {

/// Where such a stretch lies, since power-on.
struct QuietStretch {
  int test = 1;
  std::string segment;
  double from_s = 0.0, to_s = 0.0;
};

/// Of the windows of a wait that follow one another without a gap; empty when none is long enough
/// for a curve. `points` are the valid ones of a run in time order.
std::optional<QuietStretch> quiet_stretch(std::span<const procedures::Point> points);

/// The noise terms of IEEE 952, read from the Allan deviation of a stretch.
struct NoiseTerms {
  std::int64_t run = 0;
  QuietStretch stretch;
  double interval_s = 0.0;  ///< of the averages that the curve is made of
  std::size_t samples = 0;
  std::vector<model::AllanPoint> curve;
  std::optional<model::AllanFit> fit;  ///< empty: too short a curve
};

/// Reads the whole raw stream and checks it chunk by chunk; the noise terms when `stretch` is
/// given and no second of it is without frames for most of its length.
/// Errors: kStore for a damaged stream.
Result<std::optional<NoiseTerms>> read_noise_terms(record::RunLogReader& reader,
                                                   const record::StoredRun& run,
                                                   const std::optional<QuietStretch>& stretch);

}  // namespace fogbench::acceptance
