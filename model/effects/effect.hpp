#pragma once
// A physical effect that a gyro may have: its shape on a table's signals, and all that anybody asks
// of it.

#include <Eigen/Core>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/result.hpp"
#include "model/table/signals.hpp"

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
  /// A signal of which it is a period: one that hardly fits into its span looks like a curve.
  std::string_view period_of = {};
  /// An instant at which something jumps: the likelihood is a staircase, without a tangent.
  bool instant = false;
};

/// What a challenge may draw, and by which ready procedures it then shows.
struct InChallenge {
  enum class By { kSweep, kHeating, kBoth };
  struct Range {
    double minimum, maximum;
  };
  By by;
  int place;  ///< among those that are drawn: a seed means the same whatever the catalogue's order
  /// Of the simulator's inner parameters: inside the typical range, and where the procedure can
  /// tell them.
  std::map<std::string, Range> ranges = {};
};

/// Everything that is known of an effect beside its regressor.
struct EffectInfo {
  /// Parts of the documentation, in its order.
  enum class Group { kConstant, kTime, kTemperature, kField, kBench };

  std::string id;
  std::string family = {};  ///< "magnetic_linear", of one effect for each axis; empty: it is alone
  Group group = Group::kConstant;
  std::string formula;               ///< "play_width(h_z)", for people
  std::vector<std::string> columns;  ///< of the regressor: {""} or {"cos", "sin"}
  std::vector<std::string> units;    ///< of each column's coefficient
  std::vector<std::string> signals;  ///< table columns needed ("temperature_c")
  std::vector<InnerParameter> parameters = {};
  std::string excited_by;
  std::string confused_with;
  std::string source;
  /// The regressor depends on earlier rows of the run: it is computed on whole signals, never on a
  /// block of them.
  bool has_history = false;
  /// The effect of the catalogue that this is another form of; empty: it is one itself.
  std::string form_of = {};
  /// The simpler effect that it becomes at one end of its inner parameter; empty: none.
  std::string limit = {};
  /// Acts on the scale of the whole run: a random walk may look like it.
  bool slow = false;
  /// Along one axis of the field: what a shield's history or the coils' calibration scales as one.
  bool field_sensitivity = false;
  /// A thermometer that reads late makes of the model's own slope an effect of this shape.
  bool like_a_late_thermometer = false;
  /// A signal that is not moved without this one showing, in any gyro: who plans a measurement that
  /// moves it for the first time plans with this effect in the model. Empty: none.
  std::string elementary_in = {};
  /// Why signals that all move cannot show it yet ("temperature_c is never lowered"); empty: they
  /// can. Null: moving is enough.
  std::function<std::string(const Signals&)> hidden_because = nullptr;
  /// Null: no ready procedure tells it from the others.
  std::optional<InChallenge> in_challenge = {};

  /// Something jumps at the instant that is its inner parameter.
  bool is_jump() const { return !parameters.empty() && parameters.front().instant; }
};

/// An effect's columns on the rows of the signals, at a value of its first inner parameter (ignored
/// where it has none).
using Shape = std::function<Eigen::MatrixXd(double)>;

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
  /// The same physics in other shapes, which count as the effect itself (effects/shapes.hpp); the
  /// signals must outlive them. Most effects have none.
  virtual std::vector<Shape> other_shapes(const Signals&) const { return {}; }
};

}  // namespace fogbench::model
