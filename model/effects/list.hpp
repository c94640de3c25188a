#pragma once
// One function an effect (a family for x, y, z), each defined in the file of its name.

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {

const FunctionEffect& bias();
const FunctionEffect& bias_step();
const FunctionEffect& drift_linear();
const FunctionEffect& warm_up();
const Family& temperature_polynomial();  ///< linear, quadratic, cubic
const FunctionEffect& temperature_rate();
const FunctionEffect& temperature_rate_lagged();
const FunctionEffect& temperature_acceleration();
const FunctionEffect& temperature_rate_cross();
const FunctionEffect& temperature_gradient();
const FunctionEffect& temperature_hysteresis();
const FunctionEffect& temperature_ripple();
const FunctionEffect& heater_power();
const FunctionEffect& ambient_temperature();
const Family& magnetic_linear();
const Family& magnetic_quadratic();
const Family& magnetic_cross();  ///< xy, yz, zx
const Family& magnetic_saturation();
const Family& magnetic_hysteresis();
const Family& magnetic_settling();
const Family& magnetic_temperature();
const FunctionEffect& coil_heating();
const FunctionEffect& earth_rate_projection();

}  // namespace fogbench::model::effects
