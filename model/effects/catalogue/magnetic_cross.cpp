// An error in proportion to the product of the fields along two axes.
//
// In no challenge: their procedures never energise two axes together.

#include <fmt/format.h>

#include "model/effects/function_effect.hpp"
#include "model/table/moving_signals.hpp"

namespace fogbench::model::effects {
namespace {

/// Of the product of both maxima.
constexpr double kTogether = 0.1;

FunctionParts product(const Axis& a, const Axis& b) {
  return {
      .info = {.id = "magnetic_cross_" + a.letter + b.letter,
               .group = EffectInfo::Group::kField,
               .formula = a.h + " " + b.h,
               .columns = {""},
               .units = {"deg/h per (100 uT)^2"},
               .signals = {a.signal, b.signal},
               .excited_by = "two axes energised together, never by sweeps of one axis",
               .confused_with = "magnetic_quadratic_*, where the field is turned between the axes",
               .source = "second term of the expansion in the field",
               .hidden_because = [a, b](const Signals& signals) -> std::string {
                 const auto x = moving_signal(signals, a.signal, least_excitation(a.signal));
                 const auto y = moving_signal(signals, b.signal, least_excitation(b.signal));
                 if (x && y) {
                   const double together = (x->value.array() * y->value.array()).abs().maxCoeff();
                   const double most =
                       x->value.cwiseAbs().maxCoeff() * y->value.cwiseAbs().maxCoeff();
                   if (together >= kTogether * most) return {};
                 }
                 return fmt::format("{} and {} are never energised together", a.signal, b.signal);
               }},
      .regressor = [a, b](const Signals& signals, std::span<const double>) -> Eigen::MatrixXd {
        return a.field(signals) * b.field(signals);
      },
  };
}

}  // namespace

Family magnetic_cross() {
  const Axis x{"x"}, y{"y"}, z{"z"};
  return {product(x, y), product(y, z), product(z, x)};
}

}  // namespace fogbench::model::effects
