#pragma once
// Effects that the present data could not show: the experiments that would, the columns to record.

#include <vector>

#include "model/next/experiments.hpp"
#include "model/next/next_measurement.hpp"

namespace fogbench::model {

/// For effects whose signals are recorded but never moved: few experiments that show them all, each
/// with the coefficient from which on it shows them.
std::vector<NextMeasurement> experiments_for_unseen(const NextMeasurementInput& input,
                                                    const Recorded& present,
                                                    const std::vector<Experiment>& experiments);
/// For effects whose signals nobody recorded, one line an instrument.
std::vector<NextMeasurement> columns_to_record(const NextMeasurementInput& input);

}  // namespace fogbench::model
