#pragma once
// What to measure next: the experiment of those that the bench can do (experiments.hpp) which tells
// the members of an ambiguous set apart in the least bench time, computed with the effects' own
// equations, the fitted coefficients and the fitted noise. The criterion is T-optimality (A. C.
// Atkinson, V. V. Fedorov, Biometrika 62 (1975) 57); against a random walk, which is a noise and
// not a regressor, its extension by the Kullback-Leibler divergence (J. Lopez-Fidalgo, C. Tommasi,
// P. C. Trandafir, J. R. Statist. Soc. B 69 (2007) 231).

#include <string>
#include <vector>

#include "config/model_file.hpp"
#include "model/diagnose/library.hpp"
#include "model/next/experiments.hpp"
#include "model/noise/noise.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

struct NextMeasurement {
  enum class Purpose {
    kTellApart,  ///< the members of an ambiguous set
    kNoneTells,  ///< nothing that this bench can do tells them apart
    kShow,       ///< effects that these data never excited, or columns that nobody recorded
  };

  std::vector<std::string> tells_apart;
  std::string action;
  /// Expected whitened distance of the two most alike, from this measurement alone; 0 where the
  /// measurement is to show effects that these data never excited.
  double separation = 0.0;
  double hours = 0.0;  ///< on the bench, power-on to end, all repetitions
  int times = 1;
  Purpose purpose = Purpose::kTellApart;
  std::string experiment;  ///< its key (experiments.hpp); empty: none, or a column to record
};

struct NextMeasurementInput {
  const Table& present;             ///< what was analysed, in the order of runs and time
  const config::ModelFile& fitted;  ///< the model with the effects that were found, fitted
  NoiseCoefficients noise;
  /// Each set's first member stands in `fitted`; "random_walk" may be among the others. Names that
  /// the catalogue lacks are left out.
  const std::vector<std::vector<std::string>>& ambiguous;
  const std::vector<NotTestable>& not_testable;
  BenchReach reach = {};  ///< of the bench that would do it
};

/// At most two lines for each ambiguous set and each rival, then one line for all effects that one
/// experiment would show for the first time, then the columns that nobody recorded.
std::vector<NextMeasurement> next_measurements(const NextMeasurementInput& input);

}  // namespace fogbench::model
