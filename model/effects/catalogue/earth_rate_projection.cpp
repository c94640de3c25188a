// The Earth's rate on a sensitive axis that is not quite vertical, or not quite level.
//
// In no challenge: one rotation is a bias step.

#include <numbers>

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

Family earth_rate_projection() {
  return {{
      .info = {.id = "earth_rate_projection",
               .group = EffectInfo::Group::kBench,
               .formula = "cos, sin of the azimuth",
               .columns = {"cos", "sin"},
               .units = {"deg/h", "deg/h"},
               .signals = {"azimuth_deg"},
               .excited_by =
                   "rotation; the horizontal part of the Earth rate is 8.47 deg/h at 55.75 N",
               .confused_with = "bias_step; a bias of each orientation",
               .source = "IEEE Std 952, multi-position test",
               .elementary_in = "azimuth_deg"},
      .regressor = [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        const Eigen::ArrayXd angle =
            std::numbers::pi / 180.0 * signals.signal("azimuth_deg").array();
        Eigen::MatrixXd columns(angle.size(), 2);
        columns << angle.cos(), angle.sin();
        return columns;
      },
  }};
}

}  // namespace fogbench::model::effects
