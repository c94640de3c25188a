// The settled temperature error, a polynomial in t = T - T_ref.

#include "model/effects/function_effect.hpp"

namespace fogbench::model::effects {
namespace {

constexpr const char* kPolynomial = "The acceptance procedure: polynomial of the temperature error";

}  // namespace

Family temperature_polynomial() {
  return {
      {.info = {.id = "temperature_linear",
                .group = EffectInfo::Group::kTemperature,
                .formula = "t",
                .columns = {""},
                .units = {"deg/h/degC"},
                .signals = {"temperature_c"},
                .excited_by = "plateaus at several temperatures",
                .confused_with =
                    "temperature_quadratic and temperature_cubic over a short range; heater_power",
                .source = kPolynomial,
                .elementary_in = "temperature_c"},
       .regressor = [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
         return excess_temperature(signals);
       }},
      {.info = {.id = "temperature_quadratic",
                .group = EffectInfo::Group::kTemperature,
                .formula = "t^2",
                .columns = {""},
                .units = {"deg/h/degC^2"},
                .signals = {"temperature_c"},
                .excited_by = "plateaus at several temperatures",
                .confused_with = "temperature_linear over a short range",
                .source = kPolynomial,
                .elementary_in = "temperature_c",
                .in_challenge = InChallenge{InChallenge::By::kHeating, 4}},
       .regressor = [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
         return excess_temperature(signals).square();
       }},
      {.info = {.id = "temperature_cubic",
                .group = EffectInfo::Group::kTemperature,
                .formula = "t^3",
                .columns = {""},
                .units = {"deg/h/degC^3"},
                .signals = {"temperature_c"},
                .excited_by = "plateaus at four temperatures or more",
                .confused_with = "temperature_linear, temperature_quadratic over a short range",
                .source = kPolynomial,
                .in_challenge = InChallenge{InChallenge::By::kHeating, 5}},
       .regressor = [](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
         return excess_temperature(signals).cube();
       }},
  };
}

}  // namespace fogbench::model::effects
