#include "model/diagnose/adequacy.hpp"

#include <algorithm>

#include "model/diagnose/calibration.hpp"

namespace fogbench::model {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr Index kAdequacyDraws = 499;
constexpr std::size_t kMostNames = 3;
// Smooth blocks have up to six columns.
constexpr Index kFewestRowsForShapes = 12;

}  // namespace

Adequacy check_adequacy(const NoiseShapes& shapes, const Eigen::MatrixXd& base, const VectorXd& y,
                        const Library& smooth, std::uint64_t seed) {
  Adequacy out;
  if (base.rows() - base.cols() < kFewestRowsForShapes || smooth.candidates.empty()) return out;
  const Detector detector(shapes, base, smooth, y);
  const Calibration calibration(
      detector.lambdas_at_null_noise(detector.draw(kAdequacyDraws, seed)));
  const VectorXd lead = calibration.lead(detector.observed_at_null_noise());
  std::vector<Index> testable;
  for (Index c = 0; c < lead.size(); ++c) {
    if (detector.testable(c)) testable.push_back(c);
  }
  if (testable.empty()) return out;
  std::sort(testable.begin(), testable.end(), [&](Index a, Index b) { return lead[a] > lead[b]; });
  out.p_value = calibration.p_value(lead[testable.front()], testable);
  for (const Index c : testable) {
    if (lead[c] <= 0.0 || out.depends_on.size() == kMostNames) break;
    out.depends_on.push_back(smooth.candidates[static_cast<std::size_t>(c)].name);
  }
  return out;
}

}  // namespace fogbench::model
