#pragma once

#include <Eigen/Core>

#include "model/diagnose/working_table.hpp"
#include "model/table/signals.hpp"

namespace fogbench::model {

/// The model's terms without the numbers of an earlier fit: what is not held is fitted anew.
config::ModelFile unfitted(config::ModelFile model);

/// A model's columns on the coarse rows of a working table, tangents of its inner parameters
/// included, of full rank; and the observable less the terms that are held.
struct BaseColumns {
  Eigen::MatrixXd columns;
  Eigen::VectorXd y;
};

/// `signals` of table.fine(). Errors: those of Design::make.
Result<BaseColumns> base_columns(const WorkingTable& table, const Signals& signals,
                                 const config::ModelFile& fitted);

}  // namespace fogbench::model
