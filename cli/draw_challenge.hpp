#pragma once
// What the gyro of a challenge hides, and the procedure that lets an engineer find it.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/model_file.hpp"
#include "config/scenario.hpp"

namespace fogbench::cli {

/// A bench, and what of it matters here.
struct ChallengeRoom {
  std::optional<std::string> bench = {};   ///< none: the usual one
  std::vector<std::string> channels = {};  ///< of its auxiliary sensors: causes that may act
};

/// A draw before it was measured: each hidden effect has the amplitude 1 or -1.
struct ChallengeDraw {
  std::optional<std::string> bench;                ///< none: the usual one
  std::string procedure;                           ///< a ready one
  std::map<std::string, std::vector<double>> set;  ///< its parameters, where not as they stand
  std::string noise;                               ///< grade
  config::ScenarioConfig scenario;
  /// By hidden effect: how much of it the model cannot take up, RMS over the rows, in multiples of
  /// what noise alone leaves there.
  std::vector<double> visibility;
  config::ModelFile model;  ///< to start from: a bias and what the procedure excites, linear
  std::uint64_t bench_seed = 0;
};

inline constexpr std::size_t kMostHidden = 2;

/// Of 40 draws, on average: 5 hide nothing, 27 one effect, 8 two effects of different kinds. What
/// the bench's auxiliary sensors measure is one kind more.
ChallengeDraw draw_challenge(std::uint64_t seed, const ChallengeRoom& room = {});

/// Rounded, so that a revealed number is one that a person would have chosen.
double three_digits(double value);

/// Every effect that a challenge may hide there.
std::vector<std::string> hideable_effects(const ChallengeRoom& room = {});

}  // namespace fogbench::cli
