#pragma once
// What the study keeps of each trial, as a line of tab-separated text, so that parts run on
// different days make one table.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "tests/benchmark/diagnosis_baselines.hpp"
#include "tests/support/diagnosis_trial.hpp"

namespace fogbench::tests {

struct Record {
  std::string part, design, noise, truth;
  double s = 0.0;
  long rows = 0;
  std::uint64_t trial = 0, seed = 0;
  Outcome outcome = Outcome::kAdequate;
  std::vector<Outcome> baselines;  ///< in the order of kBaselines; empty: not asked
  double inner = 0.0;              ///< parameter of the first hidden effect
  double cosine = 0.0;  ///< with the nearest other effect of the catalogue, first hidden effect
  std::string nearest;
  double seconds = 0.0;         ///< of the verdict
  double formula_floors = 0.0;  ///< Answer::formula_floors
  std::string says;
  std::string contradiction;  ///< within the verdict; empty: none
};

/// "truth" of a case: "magnetic_hysteresis_z~other", "nothing, static_record".
std::string truth_of(const DiagnosisCase& what);

/// Runs one trial: the diagnosis, and the baselines when asked.
Record run_trial(TrialMaker& maker, const DiagnosisCase& what, std::uint64_t number,
                 bool with_baselines);

std::string to_line(const Record& record);
/// Errors: kBadInput: cannot be read, or a line of another form (named by number).
Result<std::vector<Record>> read_records(const std::filesystem::path& file);

}  // namespace fogbench::tests
