// The constant part of the error.

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family bias() {
  return {{
      .info = {.id = "bias",
               .group = EffectInfo::Group::kConstant,
               .formula = "1",
               .columns = {""},
               .units = {"deg/h"},
               .signals = {},
               .excited_by = "always",
               .confused_with = "nothing, unless another term is constant in these data",
               .source = "IEEE Std 952"},
      .regressor = [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return Eigen::VectorXd::Ones(static_cast<Eigen::Index>(signals.rows()));
      },
  }};
}

}  // namespace fogbench::model::effects
