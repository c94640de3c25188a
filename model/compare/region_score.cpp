#include "model/compare/region_score.hpp"

#include <cmath>

#include "model/diagnose/calibration.hpp"
#include "model/diagnose/detector.hpp"
#include "model/diagnose/search.hpp"

namespace fogbench::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr Index kRegionDraws = 999;
constexpr Index kRegionDrawsManyRows = 499;
constexpr Index kManyWindows = 400;

}  // namespace

RegionScores score_regions(const NoiseShapes& shapes, const MatrixXd& x, const VectorXd& y,
                           const MatrixXd& indicators, std::uint64_t seed) {
  const Index regions = indicators.cols();
  Library library;
  library.columns = indicators;
  for (Index g = 0; g < regions; ++g) {
    library.candidates.push_back({});
    library.candidates.back().blocks.push_back({.first = g});
  }
  const MatrixXd base = full_rank(x);
  const WhitenedLibrary whitened(shapes, library);
  const Detector detector(whitened, base, y);
  const Index draws = shapes.rows() > kManyWindows ? kRegionDrawsManyRows : kRegionDraws;
  const Calibration calibration(detector.lambdas(detector.draw(draws, seed)));
  const VectorXd lead = calibration.lead(detector.observed());
  std::vector<Index> testable;
  for (Index g = 0; g < regions; ++g) {
    if (detector.testable(g)) testable.push_back(g);
  }
  RegionScores out{.offset = VectorXd::Zero(regions),
                   .z = VectorXd::Zero(regions),
                   .family_wise = VectorXd::Ones(regions)};
  for (const Index g : testable) {
    out.offset[g] = detector.coefficients(g).value[0];
    out.z[g] = std::copysign(std::sqrt(std::max(0.0, detector.observed()[g])), out.offset[g]);
    out.family_wise[g] = calibration.p_value(lead[g], testable);
  }
  return out;
}

}  // namespace fogbench::model
