#pragma once
// An effect as its description and its functions: what every file of catalogue/ is made of.

#include <memory>
#include <utility>

#include "model/effects/effect.hpp"

namespace fogbench::model::effects {

/// May capture the axis of its family.
using Columns = std::function<Eigen::MatrixXd(const Signals&, std::span<const double> inner)>;

struct FunctionParts {
  EffectInfo info;
  Columns regressor;
  Columns starts = nullptr;  ///< of an effect with a memory
  /// Each called with the signals and the first inner parameter.
  std::function<std::vector<Shape>(const Effect& own, const Signals&)> other_shapes = nullptr;
};

class FunctionEffect final : public Effect {
 public:
  explicit FunctionEffect(FunctionParts parts) : parts_(std::move(parts)) {}

  const EffectInfo& info() const override { return parts_.info; }
  Eigen::MatrixXd regressor(const Signals& signals, std::span<const double> inner) const override {
    return parts_.regressor(signals, inner);
  }
  Eigen::MatrixXd starts(const Signals& signals, std::span<const double> inner) const override {
    if (parts_.starts) return parts_.starts(signals, inner);
    return Eigen::MatrixXd(static_cast<Eigen::Index>(signals.rows()), 0);
  }
  std::vector<Shape> other_shapes(const Signals& signals) const override {
    return parts_.other_shapes ? parts_.other_shapes(*this, signals) : std::vector<Shape>{};
  }

 private:
  FunctionParts parts_;
};

/// What a file of catalogue/ defines, in a function of its own name.
using Family = std::vector<FunctionParts>;

/// h: the field of `column` in units of 100 uT.
inline Eigen::ArrayXd field(const Signals& signals, std::string_view column) {
  return signals.signal(column) / kFieldUnitUt;
}

/// t: the temperature above the reference, degC.
inline Eigen::ArrayXd excess_temperature(const Signals& signals) {
  return signals.signal("temperature_c").array() - signals.reference_temperature_c();
}

/// An axis of the field in the gyro.
struct Axis {
  std::string letter;                              ///< "x"
  std::string signal = "field_" + letter + "_ut";  ///< its column
  std::string h = "h_" + letter;                   ///< in formulas
  /// "magnetic_linear" -> "magnetic_linear_x"
  std::string of(std::string_view family) const { return std::string(family) + "_" + letter; }
  Eigen::ArrayXd field(const Signals& signals) const { return effects::field(signals, signal); }
  /// A curve, or a loop, needs three levels of the field at least.
  std::function<std::string(const Signals&)> needs_three_levels() const;
};

/// `make` is called with the x, the y and the z axis; it need not set the id.
Family along_each_axis(std::string_view family, FunctionParts (*make)(const Axis&));

}  // namespace fogbench::model::effects
