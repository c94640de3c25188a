#include "model/diagnose/formula_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "config/channels.hpp"
#include "model/diagnose/working_table.hpp"
#include "model/effects/expression.hpp"
#include "model/table/moving_signals.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kThresholds = 15;  // of a variable, evenly over its range
constexpr int kPlaces = 9;       // of bells and of factors that switch
constexpr double kPeriodRatio = 1.15;
constexpr double kRowsPerPeriod = 4.0;
constexpr double kWavesOfAField = 6.0;  // in its range; time takes more

class Parts {
 public:
  explicit Parts(const Signals& signals) : signals_(signals) {
    for (MovingSignal& s : moving_signals(signals)) variables_.push_back(std::move(s));
    for (const std::string& name : signals.table().column_names()) {
      if (config::is_point_channel(name) || is_made_for_analysis(name)) continue;
      if (auto s = moving_signal(signals, name)) variables_.push_back(std::move(*s));
    }
  }

  std::vector<FormulaPart> all() {
    for (const MovingSignal& v : variables_) {
      if (v.name == "azimuth_deg") {
        add_angle(v);
      } else {
        add_powers(v);
        add_thresholds(v);
        add_curves(v);
        add_waves(v);
      }
    }
    for (const MovingSignal& a : variables_) {
      for (const MovingSignal& b : variables_) {
        if (a.name != b.name) add_products(a, b);
      }
    }
    return std::move(parts_);
  }

 private:
  void add(std::string text, double length, std::vector<double> constants = {},
           std::vector<double> freedom = {}) {
    freedom.resize(constants.size(), 0.0);
    parts_.push_back({std::move(text), std::move(constants), std::move(freedom), length});
  }

  static bool changes_sign(const MovingSignal& v) {
    return v.minimum < -0.1 * v.span() && v.maximum > 0.1 * v.span();
  }

  void add_powers(const MovingSignal& v) {
    const std::string& x = v.name;
    add(x, 1.0);
    add(x + "^2", 2.0);
    add(x + "^3", 2.0);
    add(x + "^4", 2.0);
    if (!changes_sign(v)) return;
    add("abs(" + x + ")", 2.0);
    add("sqrt(abs(" + x + "))", 3.0);
    add("sign(" + x + ")", 2.0);
    add("abs(" + x + ")^3", 3.0);
    add("max(" + x + ", 0)", 2.0);
    add("max(" + x + ", 0)^2", 3.0);
  }

  void add_thresholds(const MovingSignal& v) {
    const std::string& x = v.name;
    const double step = v.span() / (kThresholds + 1);
    for (int i = 1; i <= kThresholds; ++i) {
      const double at = v.minimum + i * step;
      add("max(" + x + " - {0}, 0)", 3.0, {at}, {step});
      add("(" + x + " > {0})", 3.0, {at}, {step});
      add("sqrt(max(" + x + " - {0}, 0))", 4.0, {at}, {step});
    }
    if (!changes_sign(v)) return;
    const double most = std::max(-v.minimum, v.maximum);
    for (int i = 1; i <= kPlaces; ++i) {
      const double at = most * i / (kPlaces + 1);
      add("sign(" + x + ") * max(abs(" + x + ") - {0}, 0)", 4.0, {at}, {most / kPlaces});
    }
  }

  void add_curves(const MovingSignal& v) {
    const std::string& x = v.name;
    for (const double share : {0.08, 0.15, 0.25, 0.4, 0.7}) {
      const double scale = share * v.span();
      // Counted from where it is largest, so that it neither overflows nor vanishes.
      add("exp((" + x + " - {0}) / {1})", 3.0, {v.maximum, scale}, {0.0, 0.6 * scale});
      add("exp(({0} - " + x + ") / {1})", 3.0, {v.minimum, scale}, {0.0, 0.6 * scale});
      if (changes_sign(v)) add("tanh(" + x + " / {0})", 3.0, {scale}, {0.6 * scale});
      if (v.minimum >= 0.0) {
        add("ln(1 + " + x + " / {0})", 3.0, {0.1 * scale}, {0.06 * scale});
      }
    }
    const double step = v.span() / (kPlaces + 1);
    for (int i = 1; i <= kPlaces; ++i) {
      const double at = v.minimum + i * step;
      for (const double width : {0.04, 0.1, 0.2}) {
        const double w = width * v.span();
        add("exp(-((" + x + " - {0}) / {1})^2)", 4.0, {at, w}, {step, 0.6 * w});
        add("(abs(" + x + " - {0}) < {1})", 4.0, {at, w}, {step, 0.6 * w});
      }
    }
  }

  /// Sine and cosine; the phase comes out of their coefficients.
  void add_wave(const std::string& x, double period) {
    const double freedom = (kPeriodRatio - 1.0) * period;
    for (const char* f : {"sin", "cos"}) {
      add(fmt::format("{}(2 * pi * {} / {{0}})", f, x), 3.0, {period}, {freedom});
    }
  }

  void add_waves(const MovingSignal& v) {
    const bool time = v.name == "time_since_start_s";
    const double rows = static_cast<double>(signals_.rows());
    const double most = time ? rows / kRowsPerPeriod : kWavesOfAField;
    for (double waves = 0.7; waves < most; waves *= kPeriodRatio)
      add_wave(v.name, v.span() / waves);
  }

  void add_angle(const MovingSignal& v) {
    for (const int k : {1, 2, 3, 4}) {
      for (const char* f : {"sin", "cos"}) {
        add(fmt::format("{}({} * {} * pi / 180)", f, k, v.name), 3.0);
      }
    }
  }

  void add_products(const MovingSignal& a, const MovingSignal& b) {
    const std::string &x = a.name, &y = b.name;
    if (x < y) add(x + " * " + y, 2.0);
    if (x < y) add(x + "^2 * " + y + "^2", 4.0);
    add(x + "^2 * " + y, 3.0);
    if (changes_sign(a)) {
      add("abs(" + x + ") * " + y, 3.0);
      add("max(" + x + ", 0) * " + y, 3.0);
    }
    const double step = a.span() / (kPlaces + 1);
    for (int i = 1; i <= kPlaces; i += 2) {
      add("(" + x + " > {0}) * " + y, 4.0, {a.minimum + i * step}, {step});
    }
  }

  const Signals& signals_;
  std::vector<MovingSignal> variables_;
  std::vector<FormulaPart> parts_;
};

}  // namespace

std::string text_of(const FormulaPart& part) {
  std::string out = part.text;
  for (std::size_t i = 0; i < part.constants.size(); ++i) {
    const std::string mark = fmt::format("{{{}}}", i);
    std::string number = fmt::format("{:.4g}", part.constants[i]);
    if (number.starts_with('-')) number = "(" + number + ")";
    out.replace(out.find(mark), mark.size(), number);
  }
  return out;
}

std::vector<FormulaPart> formula_parts(const Signals& signals) {
  return Parts(signals).all();
}

Eigen::MatrixXd values_of(const std::vector<FormulaPart>& parts, const Signals& signals) {
  Eigen::MatrixXd out(static_cast<Index>(signals.rows()), static_cast<Index>(parts.size()));
  for (Index i = 0; i < out.cols(); ++i) {
    const auto expression =
        Expression::parse("formula", text_of(parts[static_cast<std::size_t>(i)]), {}, signals);
    if (expression) {
      out.col(i) = expression->evaluate(signals, {});
    } else {
      out.col(i).setConstant(kMissing);
    }
  }
  return out;
}

}  // namespace fogbench::model
