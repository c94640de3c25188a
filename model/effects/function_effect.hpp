#pragma once
// An effect as its description and one function: what every file of this folder is made of.

#include <array>
#include <utility>

#include "model/effect.hpp"

namespace fogbench::model::effects {

class FunctionEffect final : public Effect {
 public:
  using Function = Eigen::MatrixXd (*)(const Signals&, std::span<const double>);

  FunctionEffect(EffectInfo info, Function function)
      : info_(std::move(info)), function_(function) {}

  const EffectInfo& info() const override { return info_; }
  Eigen::MatrixXd regressor(const Signals& signals, std::span<const double> inner) const override {
    return function_(signals, inner);
  }

 private:
  EffectInfo info_;
  Function function_;
};

/// The three effects of an x/y/z family.
using Family = std::array<FunctionEffect, 3>;

/// Fields enter every effect as h, in units of 100 uT.
inline constexpr double kFieldUnit_ut = 100.0;

}  // namespace fogbench::model::effects
