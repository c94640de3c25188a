#pragma once
// The simulated bench that measures challenges: runs that differ by what the gyro hides only.

#include <cstdint>
#include <vector>

#include "cli/draw_challenge.hpp"
#include "config/result.hpp"
#include "daemon/session.hpp"
#include "procedures/recorder.hpp"

namespace fogbench::cli {

class ChallengeBench {
 public:
  /// Errors: kBadInput, kLimit.
  static Result<ChallengeBench> open(const ChallengeDraw& draw);

  /// The points of one run on the virtual clock, with progress on a terminal. The same seed has the
  /// same noise, so that two runs differ by their scenarios' effects alone. No run log: what is
  /// hidden stands on no disk. Errors: the instruments', kAborted by a signal.
  Result<std::vector<procedures::Point>> measure(const config::ScenarioConfig& scenario) const;

 private:
  ChallengeBench(const ChallengeDraw& draw, daemon::Setup setup, daemon::PlannedProcedure plan);

  std::uint64_t seed_;
  daemon::Setup setup_;
  daemon::PlannedProcedure plan_;
};

struct SizedChallenge {
  config::ScenarioConfig scenario;        ///< what hides, with its amplitudes
  std::vector<double> visible_deg_per_h;  ///< of each: RMS of what the model cannot take up
  double noise_deg_per_h = 0.0;           ///< RMS that the model leaves when nothing hides
};

/// Gives each hidden effect of the draw the amplitude that makes it as visible as was drawn. What
/// an effect does to the rate at amplitude 1 is the difference of two runs, exactly, whatever the
/// noise. Errors: as ChallengeBench::measure, and the fit's.
Result<SizedChallenge> size_effects(const ChallengeDraw& draw, const ChallengeBench& bench);

}  // namespace fogbench::cli
