#pragma once
// What the gyro may make of a cause that somebody recorded beside the measurement (a supply
// voltage, a pressure, a light power): generic forms over any further column of the table, each an
// effect named "form(column)". They are no list: an effect is made when its name is first asked
// for.
//
//   sensitivity(x)                    x
//   sensitivity_quadratic(x)          x^2
//   sensitivity_rate(x)               dx/dt, 1/h
//   sensitivity_lagged(x)             LPF(x; tau)
//   sensitivity_temperature_rate(x)   x dT/dt
//   sensitivity_field_x(x), _y, _z    x h

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "model/effects/effect.hpp"

namespace fogbench::model::effects {

struct SensitivityForm {
  std::string_view name;
  std::string_view formula;  ///< over x
  std::string_view unit;     ///< of the coefficient; "X" stands for the column's own
  /// A second signal that the form needs besides the column; empty: none.
  std::string_view with;
  /// The effect that is lower in order and belongs into a model that has this one; "(x)" stands for
  /// the column. Empty: none.
  std::string_view beside;
};

inline constexpr std::array<SensitivityForm, 8> kSensitivityForms = {
    {{"sensitivity", "x", "deg/h/X", "", ""},
     {"sensitivity_quadratic", "x^2", "deg/h/X^2", "", "sensitivity(x)"},
     {"sensitivity_rate", "dx/dt", "deg/h/(X/h)", "time_s", ""},
     {"sensitivity_lagged", "LPF(x; tau)", "deg/h/X", "time_s", ""},
     {"sensitivity_temperature_rate", "x dT/dt", "deg/h/(degC/h)/X", "temperature_rate_c_per_h",
      "temperature_rate"},
     {"sensitivity_field_x", "x h_x", "deg/h per 100 uT/X", "field_x_ut", "magnetic_linear_x"},
     {"sensitivity_field_y", "x h_y", "deg/h per 100 uT/X", "field_y_ut", "magnetic_linear_y"},
     {"sensitivity_field_z", "x h_z", "deg/h per 100 uT/X", "field_z_ut", "magnetic_linear_z"}}};

/// "sensitivity_rate(supply_v)".
std::string sensitivity_of(const SensitivityForm& form, std::string_view column);
/// The effect of that name; null when it is not "form(column)". The same object every time, for as
/// long as the program runs. May be called from any thread.
const Effect* find_sensitivity(std::string_view id);

/// The form's values for the values `x` of its column on the signals' rows (which may be the
/// column's, or what is left of it when its mean is taken off), and NaN where the second signal is
/// missing. `tau_s` of the lagged form.
Eigen::VectorXd sensitivity_values(const SensitivityForm& form, const Signals& signals,
                                   const Eigen::VectorXd& x, double tau_s);
/// What they may lack because nobody knows how the lag began (Effect::starts); no columns for the
/// other forms.
Eigen::MatrixXd sensitivity_starts(const SensitivityForm& form, const Signals& signals,
                                   const Eigen::VectorXd& x, double tau_s);

}  // namespace fogbench::model::effects
