#pragma once

#include "config/model_file.hpp"
#include "model/noise.hpp"
#include "model/table.hpp"

namespace fogbench::model {

/// RMS of predictions of rows that took no part in the fit, in the observable's unit: eight blocks
/// of neighbouring rows are left out in turn, the coefficients fitted to the others (inner
/// parameters as `fitted` has them, weighted by `noise`), and the block predicted by the model
/// alone, without interpolating the noise. NaN when the rows do not suffice.
/// `windows`: of the table's rows, which are in order and complete.
double heldout_rms(const Table& table, const Windows& windows, const config::ModelFile& fitted,
                   const NoiseCoefficients& noise);

}  // namespace fogbench::model
