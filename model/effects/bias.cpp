// The constant part of the error.

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const FunctionEffect& bias() {
  static const FunctionEffect effect(
      {.id = "bias",
       .formula = "1",
       .columns = {""},
       .units = {"deg/h"},
       .signals = {},
       .parameters = {},
       .excited_by = "always",
       .confused_with = "nothing, unless another term is constant in these data",
       .source = "IEEE Std 952"},
      [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return Eigen::VectorXd::Ones(static_cast<Eigen::Index>(signals.rows()));
      });
  return effect;
}

}  // namespace fogbench::model::effects
