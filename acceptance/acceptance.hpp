#pragma once
// Everything that a verdict and a passport rest on, gathered from runs of the run log: for each
// test the fitted coefficients, K of each swept axis, the set points of the thermostat; the noise
// terms; and what made the runs.
//
// The results that a limits file may name (acceptance/passport.md):
//   the model's coefficients by name     of a fit of one test's points (model/fit/fit.hpp)
//   K_x, K_y, K_z                        from the extreme levels of the axis's first sweep
//   temperature_sigma                    pooled scatter of the averages at a set point
//   angle_random_walk, bias_instability, rate_random_walk   from the Allan deviation

#include <optional>
#include <string>
#include <vector>

#include "acceptance/quiet_record.hpp"
#include "acceptance/results.hpp"
#include "acceptance/set_points.hpp"
#include "config/model_file.hpp"
#include "config/result.hpp"
#include "model/compare/compare.hpp"
#include "model/compare/conformity.hpp"
#include "model/fit/fit.hpp"
#include "record/run_log_reader.hpp"

namespace fogbench::acceptance {

struct AcceptanceOptions {
  /// Empty: per test the ready model of what was excited: thermal, magnetic or general.
  std::optional<config::ModelFile> model;
  bool unfinished = false;  ///< also runs that were not completed
};

/// One test of one run.
struct TestResults {
  std::string name;  ///< "1", or "7/1" (run/test) when there are several runs
  std::int64_t run = 0;
  RunResults results;
  std::vector<SetPoint> set_points;
  std::string model;  ///< name of the fitted one; empty: nothing was excited
  std::optional<model::FitResult> fit;
  std::string fit_problem;  ///< why there is no fit
};

/// What made one run.
struct RunProvenance {
  record::StoredRun run;
  std::vector<procedures::InstrumentRecord> instruments;
  std::string raw_sha256;       ///< of the raw data as they are now
  bool raw_data_intact = true;  ///< and it is the one that was written at the end
  bool taken_up = false;        ///< the next run of the list went on where it stopped

  bool whole() const { return taken_up || run.completed(); }
};

struct Acceptance {
  std::vector<RunProvenance> runs;  ///< before a run that takes up others, these
  std::vector<TestResults> tests;
  std::vector<NoiseTerms> noise;
  std::vector<model::Measured> measured;
  /// Of the magnetic coefficients, from each test to the next that has them.
  std::vector<model::RunChange> changes;

  const std::string& gyro() const { return runs.front().run.header.gyro_serial_number; }
};

/// Precondition: at least one run.
/// Errors: kBadInput: no such run, one that was not completed (unless asked for), none of its
/// points valid, runs of different gyros; kStore.
Result<Acceptance> gather_acceptance(record::RunLogReader& reader,
                                     const std::vector<std::int64_t>& runs,
                                     const AcceptanceOptions& options);

}  // namespace fogbench::acceptance
