#pragma once
// The catalogue's own columns on a table, cleared of a base model: what the baselines choose from,
// and what a hidden effect may be confused with.

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "config/model_file.hpp"
#include "model/table/signals.hpp"

namespace fogbench::tests {

using Whitening = std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>;

struct CandidateColumns {
  /// One effect at one value of its inner parameter.
  struct Group {
    std::string effect;
    Eigen::Index first = 0, width = 0;
    double inner_parameters = 0.0;
  };

  Eigen::MatrixXd columns;  ///< whitened, cleared of the base, of length 1
  Eigen::VectorXd y;        ///< whitened, cleared of the base
  Eigen::Index base_columns = 0;
  std::vector<Group> groups;  ///< columns that the base takes up are left out

  /// The group of another effect than `own` that is nearest to a column (whitened and cleared),
  /// with the cosine between the column and its span.
  struct Nearest {
    std::string effect;
    double cosine = 0.0;
  };
  Nearest nearest(const Eigen::VectorXd& column, const std::string& own) const;
};

/// Every effect that the table has the signals for and excites, inner parameters on 8
/// values, instants on 40.
/// Precondition: the model's terms are effects without inner parameters, the table has no gaps.
CandidateColumns candidate_columns(const model::Signals& signals, const config::ModelFile& model,
                                   const Whitening& whiten);

}  // namespace fogbench::tests
