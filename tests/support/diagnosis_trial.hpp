#pragma once
// One question to the diagnosis: a table of the foreign bench with something known hidden in it (or
// nothing), and what became of the answer.

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "config/model_file.hpp"
#include "model/diagnose/diagnose.hpp"
#include "tests/support/foreign_bench.hpp"

namespace fogbench::tests {

/// What is asked: trials of one case differ in seed, inner parameters and signs only.
struct DiagnosisCase {
  std::string part;  ///< of the study: "nulls", "effects", "pairs"...
  Design design = Design::kMagnetic;
  std::string noise = "navigation";
  std::vector<std::string> hidden;  ///< none: nothing is missing; two: a pair
  Shape shape = Shape::kOwn;
  double s = 0.0;  ///< signal-to-noise ratio of each hidden effect
  ForeignColumns columns;
  std::string variant;       ///< names what differs in columns or record; empty: nothing
  double quiet_hours = 0.0;  ///< length of a static record beside the table; 0: none

  /// "effects/magnetic/navigation/s12/magnetic_hysteresis_z".
  std::string name() const;
};

/// The answer against the truth.
enum class Outcome {
  kRight,       ///< exactly what was hidden, each by its name alone
  kRightInSet,  ///< the same, in sets of at most three names
  kLargeSet,    ///< the truth is in a set of more names
  kSetWithoutTruth,
  kWrongName,
  kExtra,     ///< the truth (alone or in a set) and another effect beside it
  kPartOnly,  ///< of a pair: one, and nothing beside it
  kUnexplained,
  kHedged,  ///< outside the catalogue: a name, "or another effect of this shape"
  kAdequate,
};
inline constexpr std::size_t kOutcomes = 10;
std::string_view name_of(Outcome outcome);

/// What was answered, free of how.
struct Answer {
  model::Verdict verdict = model::Verdict::kNothingMissing;
  std::vector<std::vector<std::string>> sets;  ///< one an effect found; one name: no rival
  std::string or_shape;                        ///< of the first effect found
  std::string contradiction;                   ///< contradiction_in(); empty: none
  double formula_floors =
      std::numeric_limits<double>::infinity();  ///< of what has no name: RMS of
                                                ///< rows left out over the noise floor
  std::string says;                             ///< "warm_up | drift_linear + bias_step, p ..."
};

/// What a verdict may never say beside itself, whatever the truth is; the first that it does say;
/// empty: none.
std::string contradiction_in(const model::Diagnosis& diagnosis);

/// Each hidden effect needs a set of its own. Where nothing is hidden, sets that all hold
/// "random_walk" are kRightInSet.
Outcome judge(const Answer& answer, const std::vector<std::string>& hidden);

struct Trial {
  std::uint64_t seed = 0;
  std::vector<ForeignEffect> hidden;
  model::Table table;
  std::unique_ptr<model::Table> quiet;  ///< null: none
  config::ModelFile model;              ///< what the experimenter has
};

std::uint64_t seed_of(const DiagnosisCase& what, std::uint64_t number);

/// Benches are made once each and kept. May be shared between threads.
class TrialMaker {
 public:
  /// The same case and number always give the same trial.
  Trial make(const DiagnosisCase& what, std::uint64_t number);
  std::shared_ptr<const ForeignBench> bench(const DiagnosisCase& what);

 private:
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<const ForeignBench>> benches_;
};

/// The diagnosis' answer; an error of diagnose() becomes a wrong name that says so.
Answer answer_of(const Trial& trial);

}  // namespace fogbench::tests
