#pragma once
// What a fitted model says of a table.

#include <Eigen/Core>

#include "config/model_file.hpp"
#include "config/result.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// Values of the model on the table, NaN where a signal is missing. All coefficients must be given.
/// How an effect's memory began is found from the observable where the table has it, as in a fit;
/// without it memories begin at rest.
Result<Eigen::VectorXd> predict(const Table& table, const config::ModelFile& model);

}  // namespace fogbench::model
