#pragma once
// Takes a fitted model's prediction out of the measurements.

#include <string>

#include "config/model_file.hpp"
#include "config/result.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

struct Compensation {
  std::string column;             ///< "compensated_rate_deg_per_h", of the observable's name
  std::vector<double> values;     ///< observed - predicted, one a row; NaN where either is missing
  std::size_t rows = 0;           ///< rows with a value
  double rms_before = 0.0;        ///< of the observable, over those rows
  double rms_after = 0.0;         ///< of what remains
  double deviation_before = 0.0;  ///< the same about the mean: what varies
  double deviation_after = 0.0;
};

/// Errors: kBadInput as predict(); no observable; no row that the model applies to.
Result<Compensation> compensate(const Table& table, const config::ModelFile& model);

}  // namespace fogbench::model
