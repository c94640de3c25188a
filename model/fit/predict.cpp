#include "model/fit/predict.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>

#include "model/fit/design.hpp"

namespace fogbench::model {
namespace {

/// How the memories of the model began, from the rows of the table itself: least squares on what
/// the model leaves of the observable.
void find_starts(const Signals& signals, const config::ModelFile& model, const Design& design,
                 const Eigen::VectorXd& inner, Eigen::VectorXd& coefficients) {
  const auto own = static_cast<Eigen::Index>(design.own_columns());
  const Eigen::Index count = coefficients.size() - own;
  if (count == 0 || !signals.available(model.observable)) return;
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(signals.rows()), count);
  Eigen::Index next = 0;
  for (std::size_t i = design.own_columns(); i < design.columns().size();) {
    const std::size_t term = design.columns()[i].term;
    const Eigen::MatrixXd values = design.regressor(term, inner);
    for (; i < design.columns().size() && design.columns()[i].term == term; ++i) {
      columns.col(next++) = values.col(design.columns()[i].column);
    }
  }
  const Eigen::VectorXd left =
      signals.signal(model.observable) - design.predict(coefficients, inner);
  std::vector<Eigen::Index> complete;
  for (Eigen::Index row = 0; row < left.size(); ++row) {
    if (std::isfinite(left[row]) && columns.row(row).allFinite()) complete.push_back(row);
  }
  if (complete.empty()) return;
  const Eigen::MatrixXd seen = columns(complete, Eigen::all);
  coefficients.tail(count) =
      Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(seen).solve(left(complete));
}

}  // namespace

Result<Eigen::VectorXd> predict(const Table& table, const config::ModelFile& model) {
  const Signals signals(table, model.reference_temperature_c);
  Result<Design> design = Design::make(signals, model, true);
  if (!design) return design.error();
  Eigen::VectorXd coefficients(static_cast<Eigen::Index>(design->columns().size()));
  coefficients.setZero();
  for (std::size_t i = 0; i < design->own_columns(); ++i) {
    const DesignColumn& column = design->columns()[i];
    if (!column.given) {
      return Error{
          ErrorCode::kBadInput,
          fmt::format("term {}: has no coefficient, expected a fitted model", column.name)};
    }
    coefficients[static_cast<Eigen::Index>(i)] = *column.given;
  }
  Eigen::VectorXd inner(static_cast<Eigen::Index>(design->parameters().size()));
  for (std::size_t i = 0; i < design->parameters().size(); ++i) {
    const DesignParameter& parameter = design->parameters()[i];
    if (!parameter.start) {
      return Error{ErrorCode::kBadInput,
                   fmt::format("{}: has no value, expected a fitted model", parameter.name)};
    }
    inner[static_cast<Eigen::Index>(i)] = *parameter.start;
  }
  find_starts(signals, model, *design, inner, coefficients);
  const Eigen::VectorXd ordered = design->predict(coefficients, inner);
  Eigen::VectorXd result(ordered.size());
  for (std::size_t row = 0; row < signals.rows(); ++row) {
    result[static_cast<Eigen::Index>(signals.table_row(row))] =
        ordered[static_cast<Eigen::Index>(row)];
  }
  return result;
}

}  // namespace fogbench::model
