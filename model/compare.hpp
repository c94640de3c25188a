#pragma once
// Where a fitted (or held) model misses its measurements: residual per segment and per range of
// each variable with a family-wise significance, worst first, each in a plain sentence with units;
// and what changed between runs (test 1, test 2).

#include <string>
#include <vector>

#include "config/result.hpp"
#include "model/fit.hpp"
#include "model/table.hpp"

namespace fogbench::model {

struct Region {
  std::string where;     ///< segment, or empty
  std::string variable;  ///< column name, or empty
  double from = 0.0, to = 0.0;
  std::size_t rows = 0;
  double residual = 0.0;        ///< mean residual
  double standard_error = 0.0;  ///< of that mean under the noise model
  double z = 0.0;
  double p_family_wise = 1.0;  ///< corrected for all regions looked at
  std::string says;
};

/// Two runs' coefficients against each other.
struct RunChange {
  std::string run_a, run_b;
  double common_scale = 1.0;  ///< b = scale * a, weighted least squares over the magnetic terms
  double scale_standard_error = 0.0;
  double angle_deg = 0.0;  ///< between the two coefficient vectors
  std::string says;
};

struct Comparison {
  FitResult fit;
  std::vector<Region> regions;  ///< worst first
  std::vector<RunChange> changes;
  std::vector<std::string> sentences;  ///< the conclusions, in the order to print them
  double noise_floor = 0.0;            ///< RMS that the noise alone would leave
  double p_adequate = 1.0;             ///< of the worst region
};

Result<Comparison> compare(const Table& table, const config::ModelFile& model,
                           const FitOptions& options);

}  // namespace fogbench::model
