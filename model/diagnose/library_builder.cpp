#include "model/diagnose/library_builder.hpp"

namespace fogbench::model {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd LibraryBuilder::averaged(MatrixXd fine_columns) const {
  fine_columns = fine_columns.array().isFinite().select(fine_columns, 0.0).eval();
  if (signals().available(kQuietColumn)) {
    fine_columns.array().colwise() *= 1.0 - signals().signal(kQuietColumn).array();
  }
  return source_.table.average(fine_columns);
}

void LibraryBuilder::add_block(Candidate& candidate, const MatrixXd& columns, double inner,
                               std::size_t shape) {
  if (!columns.allFinite() || columns.cwiseAbs().maxCoeff() == 0.0) return;
  candidate.blocks.push_back(
      {.first = count_, .width = columns.cols(), .shape = shape, .inner = inner});
  parts_.push_back(columns);
  count_ += columns.cols();
}

void LibraryBuilder::add_shadow(std::string name, const MatrixXd& fine_columns) {
  Candidate shadow{.name = std::move(name)};
  add_block(shadow, averaged(fine_columns));
  add(std::move(shadow));
}

void LibraryBuilder::add(Candidate candidate) {
  if (!candidate.blocks.empty()) library_.candidates.push_back(std::move(candidate));
}

void LibraryBuilder::add_on_grid(Candidate candidate, const std::vector<double>& grid) {
  for (std::size_t shape = 0; shape < candidate.shapes.size(); ++shape) {
    for (const double value : grid) {
      add_block(candidate, candidate.shapes[shape](value), value, shape);
    }
  }
  if (candidate.blocks.empty()) {
    return refuse(candidate.name, "the effect is zero everywhere in these data");
  }
  add(std::move(candidate));
}

void LibraryBuilder::refuse(std::string effect, std::string because) {
  library_.not_testable.push_back({std::move(effect), std::move(because)});
}

Library LibraryBuilder::finish() {
  library_.columns.resize(source_.table.rows(), count_);
  Index at = 0;
  for (const MatrixXd& part : parts_) {
    library_.columns.middleCols(at, part.cols()) = part;
    at += part.cols();
  }
  return std::move(library_);
}

}  // namespace fogbench::model
