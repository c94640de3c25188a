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
  /// same noise, so that two runs differ by their scenarios' effects alone. No run log:
  /// what is hidden stands on no disk. Errors: the instruments', kAborted by a signal.
  Result<std::vector<procedures::Point>> measure(const config::ScenarioConfig& scenario) const;

 private:
  ChallengeBench(const ChallengeDraw& draw, daemon::Setup setup, daemon::PlannedProcedure plan);

  std::uint64_t seed_;
  daemon::Setup setup_;
  daemon::PlannedProcedure plan_;
};

/// Gives each hidden effect of the draw its amplitude, by measuring it without noise's help: its
/// own share of the rate at amplitude 1 is the difference of two runs of one seed. Errors: as
/// ChallengeBench::measure.
struct SizedChallenge {
  config::ScenarioConfig scenario;
  std::vector<double> visible_deg_per_h;
  double noise_deg_per_h = 0.0;
};
Result<SizedChallenge> size_effects(const ChallengeDraw& draw, const ChallengeBench& bench);

}  // namespace fogbench::cli
