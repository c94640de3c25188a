#include <fmt/format.h>

#include "model/design.hpp"
#include "model/fit.hpp"

namespace fogbench::model {

Result<Eigen::VectorXd> predict(const Table& table, const config::ModelFile& model) {
  const Signals signals(table, model.reference_temperature_c);
  Result<Design> design = Design::make(signals, model, true);
  if (!design) return design.error();
  Eigen::VectorXd coefficients(static_cast<Eigen::Index>(design->columns().size()));
  for (std::size_t i = 0; i < design->columns().size(); ++i) {
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
  const Eigen::VectorXd ordered = design->predict(coefficients, inner);
  Eigen::VectorXd result(ordered.size());
  for (std::size_t row = 0; row < signals.rows(); ++row) {
    result[static_cast<Eigen::Index>(signals.table_row(row))] =
        ordered[static_cast<Eigen::Index>(row)];
  }
  return result;
}

}  // namespace fogbench::model
