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
  const WhitenedLibrary whitened(shapes, smooth);
  const Detector detector(whitened, base, y);
  const Draws draws = detector.draw(kAdequacyDraws, seed);
  const Calibration calibration(detector.lambdas_at_null_noise(draws));
  const VectorXd lead = calibration.lead(detector.observed_at_null_noise());
  std::vector<Index> testable;
  for (Index c = 0; c < lead.size(); ++c) {
    if (detector.testable(c)) testable.push_back(c);
  }
  if (testable.empty()) return out;
  std::sort(testable.begin(), testable.end(), [&](Index a, Index b) { return lead[a] > lead[b]; });
  const double p_smooth = calibration.p_value(lead[testable.front()], testable);
  // Half of the rate for what is smooth in a variable, half for innovations that are not white.
  const Calibration white(detector.whiteness(draws).transpose());
  const VectorXd observed = VectorXd::Constant(1, detector.observed_whiteness());
  const double p_white = white.p_value(white.lead(observed)[0], {0});
  out.p_value = std::min(1.0, 2.0 * std::min(p_smooth, p_white));
  if (p_white < p_smooth) out.depends_on.emplace_back("time_since_start_s");
  for (const Index c : testable) {
    if (lead[c] <= 0.0 || out.depends_on.size() == kMostNames) break;
    const std::string& name = smooth.candidates[static_cast<std::size_t>(c)].name;
    if (name != "time_since_start_s") out.depends_on.push_back(name);
  }
  return out;
}

}  // namespace fogbench::model
