#pragma once
// The catalogue of physical effects. One effect is one small file in model/effects/, with its
// identifier, formula, signals, inner parameters and source; it registers itself in the list of
// catalogue.cpp.

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/result.hpp"
#include "model/signals.hpp"

namespace fogbench::model {

/// A parameter that the rate is not linear in.
struct InnerParameter {
  std::string_view name;  ///< "width", "tau", "t0", "period", "hs"
  std::string_view unit;
  double minimum;  ///< typical range: the search grid's ends
  double maximum;
  bool logarithmic = true;  ///< spacing of the grid
  /// A signal whose observed range takes the place of the typical one; empty: none.
  std::string_view within = {};
};

struct EffectInfo {
  std::string_view id;
  std::string_view formula;               ///< "play_w(h_z)", for people
  std::vector<std::string_view> columns;  ///< of the regressor: {""} or {"cos", "sin"}
  std::vector<std::string_view> units;    ///< of each column's coefficient
  std::vector<std::string_view> signals;  ///< table columns needed ("temperature_c")
  std::vector<InnerParameter> parameters;
  std::string_view excited_by;
  std::string_view confused_with;
  std::string_view source;
  /// The regressor depends on earlier rows of the run: it is computed on whole signals, never on a
  /// block of them.
  bool has_history = false;
  /// The effect of the catalogue that this is another form of; empty: it is one itself.
  std::string_view form_of = {};
  /// The simpler effect that it becomes at one end of its inner parameter; empty: none.
  std::string_view limit = {};
};

/// An effect's regressor on a table's signals.
class Effect {
 public:
  virtual ~Effect() = default;
  virtual const EffectInfo& info() const = 0;
  /// rows x info().columns.size(), in the order of the signals; NaN where a needed signal is
  /// missing. `inner` in the order of info().parameters, within the sense of the effect (times and
  /// widths positive). Precondition: signals.missing_for(info()) is empty.
  virtual Eigen::MatrixXd regressor(const Signals& signals,
                                    std::span<const double> inner) const = 0;
  /// What the regressor may lack because nobody knows in which state its memory began: rows x any
  /// number of columns, in the regressor's unit, each zero outside one of the stretches of which
  /// the past is unknown (effects/history.hpp). Their coefficients belong to the data, not to the
  /// gyro. Physics bounds them: none is larger than the effect's own coefficient. Their number
  /// depends on the signals alone. None where the effect has no memory.
  virtual Eigen::MatrixXd starts(const Signals& signals, std::span<const double> inner) const = 0;
};

/// All effects, in the order of the documentation.
std::span<const Effect* const> catalogue();
/// Null when there is no such effect.
const Effect* find_effect(std::string_view id);
/// "unknown effect 'x', the nearest are u, v and w", of the catalogue.
std::string unknown_effect(std::string_view id);

}  // namespace fogbench::model
