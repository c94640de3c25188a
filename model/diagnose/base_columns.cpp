#include "model/diagnose/base_columns.hpp"

#include "model/diagnose/search.hpp"
#include "model/fit/design.hpp"

namespace fogbench::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

config::ModelFile unfitted(config::ModelFile model) {
  for (config::ModelTerm& term : model.terms) {
    if (term.fixed) continue;
    term.coefficient.reset();
    term.coefficients.clear();
    term.standard_errors.clear();
  }
  model.fit.reset();
  return model;
}

Result<BaseColumns> base_columns(const WorkingTable& table, const Signals& signals,
                                 const config::ModelFile& fitted) {
  const auto design = Design::make(signals, unfitted(fitted), false);
  if (!design) return design.error();
  VectorXd inner(static_cast<Index>(design->parameters().size()));
  for (Index i = 0; i < inner.size(); ++i) {
    inner[i] = design->parameters()[static_cast<std::size_t>(i)].start.value_or(1.0);
  }
  MatrixXd all;
  design->visit(inner, true, signals.signal(fitted.observable),
                [&](std::size_t begin, Eigen::Ref<MatrixXd> rows) {
                  if (all.size() == 0) {
                    all.resize(static_cast<Index>(signals.rows()), rows.cols());
                  }
                  all.middleRows(static_cast<Index>(begin), rows.rows()) = rows;
                });
  if (!all.allFinite()) {
    all = all.array().isFinite().select(all, 0.0).eval();
  }
  all = table.average(all);
  return BaseColumns{full_rank(all.leftCols(all.cols() - 1)), all.rightCols(1)};
}

}  // namespace fogbench::model
