#pragma once

#include <optional>
#include <string_view>

#include "model/fit/fit.hpp"

namespace fogbench::model {

/// A fitted loop as engineers state one: by itself, without the other terms of the model, driven
/// up and down over the largest field of the data on both sides of zero, or between their ends of
/// temperature.
struct LoopFigures {
  Estimate remanence;  ///< half the gap between the branches in the middle (zero field), deg/h
  /// Half the way between the branches at half height: the coercive field in uT, or the width in
  /// degC. NaN where they do not cross it.
  Estimate coercive;
};

/// Of a hysteresis effect or a form of it among the terms of the fit; nothing for other terms.
std::optional<LoopFigures> loop_figures(const FitResult& fit, std::string_view term,
                                        const Table& table);

}  // namespace fogbench::model
