#include "model/effects/sensitivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "config/units.hpp"
#include "model/effects/history.hpp"

namespace fogbench::model::effects {
namespace {

constexpr InnerParameter kTau{.name = "tau", .unit = "s", .minimum = 60.0, .maximum = 7200.0};

bool is_lagged(const SensitivityForm& form) {
  return form.name == "sensitivity_lagged";
}

/// Per hour, between the neighbours on both sides of a row; within runs.
Eigen::VectorXd slope_per_hour(const Signals& signals, const Eigen::VectorXd& x) {
  const Signals::View time = signals.signal("time_s");
  Eigen::VectorXd out = Eigen::VectorXd::Constant(x.size(), kMissing);
  for (const Signals::RunRange& run : signals.runs()) {
    const auto begin = static_cast<Eigen::Index>(run.begin);
    const auto end = static_cast<Eigen::Index>(run.end);
    for (Eigen::Index row = begin; row < end; ++row) {
      const Eigen::Index before = std::max(row - 1, begin), after = std::min(row + 1, end - 1);
      const double step_s = time[after] - time[before];
      if (step_s > 0.0) out[row] = (x[after] - x[before]) / step_s * config::kSecondsPerHour;
    }
  }
  return out;
}

/// "deg/h/V"; per unit of the column where its name has no unit.
std::string unit_for(const SensitivityForm& form, std::string_view column) {
  const std::string_view own = config::unit_of(column);
  std::string unit(form.unit);
  const std::size_t at = unit.find('X');
  unit.replace(at, 1, own.empty() ? std::string(column) : std::string(own));
  return unit;
}

class Sensitivity final : public Effect {
 public:
  Sensitivity(const SensitivityForm& form, std::string column)
      : form_(form), column_(std::move(column)) {
    info_.id = sensitivity_of(form, column_);
    info_.formula = form.formula;
    const std::size_t x = form.formula.starts_with("LPF") ? 4 : form.formula.starts_with("dx");
    info_.formula.replace(x, 1, column_);
    info_.columns = {""};
    info_.units = {unit_for(form, column_)};
    info_.signals = {column_};
    if (!form.with.empty()) info_.signals.emplace_back(form.with);
    if (is_lagged(form)) info_.parameters = {kTau};
    info_.excited_by = "changes of the column";
    info_.confused_with = "whatever else changes with the column";
    info_.source = "a generic form, for a cause that the catalogue does not know";
    // The slope looks at the neighbouring rows, the lag at all before.
    info_.has_history = form.with == "time_s";
  }

  const EffectInfo& info() const override { return info_; }
  Eigen::MatrixXd regressor(const Signals& signals, std::span<const double> inner) const override {
    return sensitivity_values(form_, signals, signals.signal(column_),
                              inner.empty() ? 0.0 : inner[0]);
  }
  Eigen::MatrixXd starts(const Signals& signals, std::span<const double> inner) const override {
    return sensitivity_starts(form_, signals, signals.signal(column_),
                              inner.empty() ? 0.0 : inner[0]);
  }

 private:
  const SensitivityForm& form_;
  std::string column_;
  EffectInfo info_;
};

}  // namespace

std::string sensitivity_of(const SensitivityForm& form, std::string_view column) {
  return fmt::format("{}({})", form.name, column);
}

const Effect* find_sensitivity(std::string_view id) {
  const std::size_t open = id.find('(');
  if (open == std::string_view::npos || !id.ends_with(')') || open + 2 >= id.size()) return nullptr;
  const auto form =
      std::find_if(kSensitivityForms.begin(), kSensitivityForms.end(),
                   [&](const SensitivityForm& f) { return f.name == id.substr(0, open); });
  if (form == kSensitivityForms.end()) return nullptr;
  static std::mutex mutex;
  static std::map<std::string, std::unique_ptr<const Effect>, std::less<>> made;
  const std::lock_guard lock(mutex);
  auto& effect = made[std::string(id)];
  if (!effect) {
    effect = std::make_unique<Sensitivity>(*form,
                                           std::string(id.substr(open + 1, id.size() - open - 2)));
  }
  return effect.get();
}

Eigen::VectorXd sensitivity_values(const SensitivityForm& form, const Signals& signals,
                                   const Eigen::VectorXd& x, double tau_s) {
  if (form.name == "sensitivity_quadratic") return x.array().square();
  if (form.name == "sensitivity_rate") return slope_per_hour(signals, x);
  if (is_lagged(form)) return lag(signals, x, tau_s, Gap::kLinear);
  if (form.with.empty()) return x;
  const bool field = form.with.ends_with("_ut");
  return x.cwiseProduct(signals.signal(form.with)) / (field ? kFieldUnitUt : 1.0);
}

Eigen::MatrixXd sensitivity_starts(const SensitivityForm& form, const Signals& signals,
                                   const Eigen::VectorXd& x, double tau_s) {
  if (is_lagged(form)) return lag_starts(signals, x, tau_s);
  return Eigen::MatrixXd(x.size(), 0);
}

}  // namespace fogbench::model::effects
