#pragma once
// sealed.json of a challenge: what everybody may read, and what is hidden.
//
//   hidden   the secret as JSON, in hexadecimal digits
//   seal     SHA-256 of everything else in the file
//
// An honest person does not see the answer by accident (cat, strings, grep), and changed data or a
// changed file are noticed. It stops nobody who wants to know.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "config/scenario.hpp"

namespace fogbench::cli {

inline constexpr auto kMeasurementsFile = "measurements.csv";
inline constexpr auto kModelFile = "model.json";
inline constexpr auto kSealedFile = "sealed.json";

/// What the challenge hides.
struct ChallengeSecret {
  std::string seed;  ///< as text: JSON numbers do not hold 64 bits
  config::ScenarioConfig scenario;
  /// By hidden effect: RMS over the rows of what model.json cannot take up of it.
  std::vector<double> visible_deg_per_h;
  double noise_deg_per_h = 0.0;  ///< RMS that model.json leaves when nothing is hidden
};

struct ChallengeFile {
  std::string says;
  std::string software_version;
  std::string noise;                 ///< grade
  std::optional<std::string> bench;  ///< none: the usual one
  std::string procedure;
  std::map<std::string, std::vector<double>> set;  ///< its parameters, where not as they stand
  std::string data_sha256;
  std::string hidden;
  std::string seal;
};

/// The text of sealed.json: `file` with `hidden` and `seal` made for `secret`. The same arguments
/// give the same text.
std::string sealed_text(ChallengeFile file, const ChallengeSecret& secret);

/// Opens the seal in `folder`. kBadInput, one line: missing or damaged files, data that are not
/// those which were sealed, a broken seal, a seal of an older version.
Result<ChallengeSecret> open_challenge(const std::filesystem::path& folder);

}  // namespace fogbench::cli
