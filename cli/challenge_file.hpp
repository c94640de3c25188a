#pragma once
// sealed.json of a challenge: what everybody may read, and the seal over what is hidden.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "config/scenario.hpp"

namespace fogbench::cli {

inline constexpr auto kMeasurementsFile = "measurements.csv";
inline constexpr auto kModelFile = "model.json";
inline constexpr auto kSealedFile = "sealed.json";

/// What is under the seal.
struct ChallengeSecret {
  std::string seed;  ///< as text: JSON numbers do not hold 64 bits
  config::ScenarioConfig scenario;
  /// By hidden effect: RMS over the rows of what model.json cannot take up of it.
  std::vector<double> visible_deg_per_h;
  double noise_deg_per_h = 0.0;  ///< RMS that model.json leaves when nothing is hidden
};

/// What everybody may read. Nothing here depends on what is hidden, the hash of the data apart.
struct ChallengeFile {
  std::string says;
  std::string software_version;
  std::string noise;  ///< grade
  std::string procedure;
  std::map<std::string, std::vector<double>> set;  ///< its parameters, where not as they stand
  std::string data_sha256;
  std::string seal;  ///< of the secret, made by seal_challenge
};

/// The text of sealed.json: `file`, whose `seal` is not looked at, sealed over `secret`.
std::string sealed_text(ChallengeFile file, const ChallengeSecret& secret);

/// Opens the seal in `folder`. kBadInput, one line: missing or damaged files, data that are not
/// those which were sealed, a broken seal.
Result<ChallengeSecret> open_challenge(const std::filesystem::path& folder);

}  // namespace fogbench::cli
