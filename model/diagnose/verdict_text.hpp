#pragma once
// A diagnosis in words, the same on the screen, in JSON and on the page.

#include <string>
#include <string_view>
#include <vector>

#include "model/diagnose/diagnose.hpp"

namespace fogbench::model {

struct VerdictWords {
  std::string verdict;   ///< what is missing, that nothing is, or that these data cannot tell
  std::string evidence;  ///< the numbers that carry it
  std::string to_do;     ///< "Next: COMMAND", "Measure: ...", "Try: ..."
  std::vector<std::string> details;  ///< sentences that say more, the most useful first

  /// All of them, in this order.
  std::vector<std::string> sentences() const;
};

/// `next_command`: what a reader types to go on, where the diagnosis asks for no measurement.
VerdictWords verdict_in_words(const Diagnosis& diagnosis, const std::string& next_command);

/// The measurement that `to_do` asks for; null: it asks for none, or for one that every bench
/// knows.
const NextMeasurement* proposed_measurement(const Diagnosis& diagnosis);

/// An estimate's name beside its effect's: "cos" of "earth_rate_projection.cos"; empty for the
/// effect's own coefficient; the whole name where it is another term's.
std::string_view name_beside(const std::string& effect, const std::string& estimate);

}  // namespace fogbench::model
