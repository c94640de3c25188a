#pragma once
// The search of a diagnosis: test, add the best candidate, test again, until nothing that is left
// is more than noise; then judge every addition with all the others in the model: is it still
// needed, does another candidate do as well, does a shape from outside the catalogue do better, are
// rows that took no part in the fit predicted better with it?

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/diagnose/detector.hpp"
#include "model/diagnose/heldout.hpp"
#include "model/noise/noise_shapes.hpp"

namespace fogbench::model {

/// Another explanation that the data cannot exclude.
struct Rival {
  std::string effect;
  double probability = 0.0;
};

/// Why an effect that leads cannot be named.
enum class Refusal {
  kNone,
  kAtEdge,            ///< the data push its inner parameter beyond its range
  kNotDistinguished,  ///< no coefficient is larger than its expanded uncertainty
  kComesAndGoes,      ///< a jump that a second one follows
  kNotPredicting,     ///< rows that took no part in the fit are not predicted better
};

/// An effect that the data warrant.
struct Found {
  std::size_t candidate = 0;  ///< in the library
  std::string effect;
  std::size_t shape = 0;  ///< into Candidate::shapes
  double inner = 0.0;     ///< value of the inner parameter, where there is one
  /// Further points of the effect's grid whose columns it takes too: a real loop bends where one
  /// play operator does not, and its rest is no second effect.
  std::vector<Block> more;
  double p_value = 1.0;
  double probability = 1.0;   ///< against its rivals
  std::vector<Rival> rivals;  ///< most probable first
  std::string or_shape;       ///< a shadow that cannot be excluded either
  bool shape_leads = false;   ///< it even does better
  bool inner_at_edge = false;
  HeldoutVote heldout;  ///< with it against without it, all others in the model
  Refusal refusal = Refusal::kNone;
};

/// What the data say of an effect that was not found.
struct Bound {
  std::string effect;
  double absent_or_below = 0.0;  ///< |coefficient|, 95 %
  std::string unit;
};

struct SearchResult {
  std::vector<Found> found;       ///< in the order found
  std::vector<Found> refused;     ///< what led, and could not be named
  std::vector<double> p_of_step;  ///< global p-value of each step, the refused last one included
  /// A shape from outside the catalogue, or an effect that was refused, that explains the data
  /// better than any other effect, to a degree that the effect's own world could not produce; empty
  /// when there is none.
  std::string outside_shape;
  double p_outside = 1.0;
  std::vector<Bound> bounds;
};

/// What is searched: windows of which the first `bench_rows` are the bench's, the rest a static
/// record's. `base` holds the model's own columns (with the tangents of its inner
/// parameters), of full rank; y is the observable less the terms that are held.
struct SearchInput {
  const WhitenedLibrary& whitened;
  const Windows& windows;
  Eigen::Index bench_rows;
  Eigen::MatrixXd base;
  Eigen::VectorXd y;

  const Library& tried() const { return whitened.tried(); }
  const NoiseShapes& shapes() const { return whitened.shapes(); }
};

/// Which of the found effects is not to be named, and why.
struct Refused {
  std::size_t at = 0;
  Refusal why = Refusal::kNone;
};

struct SearchOptions {
  double first_level = 0.04;   ///< of the first step
  double later_level = 0.004;  ///< of the next ones
  /// Of a shape from outside where no effect is left to be found.
  double outside_level = 0.005;
  std::size_t most_effects = 5;
  std::uint64_t seed = 20260101;
  /// Asked of effects that have passed all gates, none included: which of them a refit that leaves
  /// the grid refuses.
  std::function<std::optional<Refused>(const std::vector<Found>&)> refit;
};

/// The model needs this many rows beyond its terms, or nothing can be said of noise or structure.
inline constexpr Eigen::Index kFewestFreeRows = 7;
/// exp(-3) of the likelihood: what one parameter more may gain by noise.
inline constexpr double kNearlyAsWell = 6.0;

/// What is left beside effects that were found has to be this rare: it is asked of every table in
/// which something is found, and the right answer is to be spoiled in hardly any of them.
inline constexpr double kLeftBesideFound = 0.002;

SearchResult search(const SearchInput& input, const SearchOptions& options);

/// The base and what the found effects add to it, of full rank; `except`: one that is left out.
Eigen::MatrixXd base_with(const SearchInput& input, const std::vector<Found>& found,
                          const Found* except = nullptr);

/// Columns that the ones before them do not already span.
Eigen::MatrixXd full_rank(const Eigen::MatrixXd& columns);

}  // namespace fogbench::model
