// The Earth's rate on a sensitive axis that is not quite vertical, or not quite level.

#include <numbers>

#include "model/effects/list.hpp"

namespace fogbench::model::effects {

const FunctionEffect& earth_rate_projection() {
  static const FunctionEffect effect(
      {.id = "earth_rate_projection",
       .formula = "cos, sin of the azimuth",
       .columns = {"cos", "sin"},
       .units = {"deg/h", "deg/h"},
       .signals = {"azimuth_deg"},
       .parameters = {},
       .excited_by = "rotation; the horizontal part of the Earth rate is 8.47 deg/h at 55.75 N",
       .confused_with = "bias_step; a bias of each orientation",
       .source = "IEEE Std 952, multi-position test"},
      [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        const Eigen::ArrayXd angle =
            std::numbers::pi / 180.0 * signals.signal("azimuth_deg").array();
        Eigen::MatrixXd columns(angle.size(), 2);
        columns << angle.cos(), angle.sin();
        return columns;
      });
  return effect;
}

}  // namespace fogbench::model::effects
