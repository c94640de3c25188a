#pragma once
// An answer to a challenge, and what it is worth.

#include <filesystem>
#include <string>
#include <vector>

#include "config/result.hpp"

namespace fogbench::cli {

/// The answer "nothing is hidden".
inline constexpr auto kNothing = "nothing";

/// Names, one of which is meant: several when the data do not tell them apart.
using Claim = std::vector<std::string>;

struct Answer {
  std::vector<Claim> claims;  ///< empty: nothing is hidden
  bool unnamed = false;       ///< something is said to be there that has no name
};

/// From the command line. kBadInput: an effect that the catalogue does not have, or twice, or
/// `nothing` beside an effect.
Result<Answer> answer_from(const std::vector<std::string>& effects);

/// From the output of `fogbench diagnose --json`: an effect that it names as missing is a claim,
/// or, when it stands in an ambiguous set, that set. kBadInput, one line with the JSON pointer.
Result<Answer> read_diagnosis(const std::filesystem::path& file);

/// More names than this are no answer.
inline constexpr std::size_t kMostNames = 3;

struct Score {
  std::vector<std::string> right;     ///< hidden, and named alone
  std::vector<std::string> in_set;    ///< hidden, and among at most kMostNames names
  std::vector<std::string> missed;    ///< hidden, and not named so
  std::vector<std::string> invented;  ///< named ("a or b" for a set), and not hidden

  bool exact() const { return missed.empty() && invented.empty(); }
};

/// One claim finds one hidden effect. A set that holds `random_walk`, or too many names with a
/// hidden one among them, invents nothing.
Score score(const std::vector<std::string>& hidden, const Answer& answer);

}  // namespace fogbench::cli
