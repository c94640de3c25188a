#pragma once
// An effect as its description and one function: what every file of this folder is made of.

#include <array>
#include <utility>

#include "model/effect.hpp"

namespace fogbench::model::effects {

class FunctionEffect final : public Effect {
 public:
  using Function = Eigen::MatrixXd (*)(const Signals&, std::span<const double>);

  /// `beginnings`: the starts of an effect with a memory.
  FunctionEffect(EffectInfo info, Function function, Function beginnings = nullptr)
      : info_(std::move(info)), function_(function), starts_(beginnings) {}

  const EffectInfo& info() const override { return info_; }
  Eigen::MatrixXd regressor(const Signals& signals, std::span<const double> inner) const override {
    return function_(signals, inner);
  }
  Eigen::MatrixXd starts(const Signals& signals, std::span<const double> inner) const override {
    if (starts_ == nullptr) return Eigen::MatrixXd(static_cast<Eigen::Index>(signals.rows()), 0);
    return starts_(signals, inner);
  }

 private:
  EffectInfo info_;
  Function function_;
  Function starts_;
};

/// The three effects of an x/y/z family.
using Family = std::array<FunctionEffect, 3>;

/// h: the field of `column` in units of 100 uT.
inline Eigen::ArrayXd field(const Signals& signals, std::string_view column) {
  return signals.signal(column) / kFieldUnitUt;
}

/// t: the temperature above the reference, degC.
inline Eigen::ArrayXd excess_temperature(const Signals& signals) {
  return signals.signal("temperature_c").array() - signals.reference_temperature_c();
}

}  // namespace fogbench::model::effects
