#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "model/diagnose/library_builder.hpp"
#include "model/diagnose/moving_signals.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Largest fall of the signal from an earlier maximum, within a run.
double deepest_fall(const Signals& signals, const VectorXd& value) {
  double fall = 0.0;
  for (const Signals::RunRange& run : signals.runs()) {
    double top = value[static_cast<Index>(run.begin)];
    for (std::size_t i = run.begin; i < run.end; ++i) {
      top = std::max(top, value[static_cast<Index>(i)]);
      fall = std::max(fall, top - value[static_cast<Index>(i)]);
    }
  }
  return fall;
}

}  // namespace

std::string unexcited_because(const EffectInfo& info, const Signals& signals) {
  const std::string_view id = info.id;
  const auto field = [&](char axis) {
    const std::string name = fmt::format("field_{}_ut", axis);
    return moving_signal(signals, name, least_excitation(name));
  };
  if (id.starts_with("magnetic_cross_")) {
    const auto a = field(id[15]), b = field(id[16]);
    const std::string never =
        fmt::format("field_{}_ut and field_{}_ut are never energised together", id[15], id[16]);
    if (!a || !b) return never;
    const double together = (a->value.array() * b->value.array()).abs().maxCoeff();
    const double most = a->value.cwiseAbs().maxCoeff() * b->value.cwiseAbs().maxCoeff();
    return together < 0.1 * most ? never : "";
  }
  for (const std::string_view name : info.signals) {
    if (name == "time_s" || name == "duration_s") continue;
    if (!moving_signal(signals, name, least_excitation(name))) {
      return fmt::format("{} stays at one value", name);
    }
  }
  if (id == "temperature_hysteresis") {
    const auto t = moving_signal(signals, "temperature_c");
    const double fall = t ? deepest_fall(signals, t->value) : 0.0;
    if (!t || fall < 0.25 * t->span()) {
      return "temperature_c is never lowered: a cooling branch is needed";
    }
  }
  if (id == "temperature_ripple") {
    const auto t = moving_signal(signals, "temperature_c");
    std::set<long> plateaus;
    if (t)
      for (const double v : t->value) plateaus.insert(std::lround(v));
    if (plateaus.size() < 8) return "temperature_c takes too few values to show a period";
  }
  if (id.starts_with("magnetic_quadratic") || id.starts_with("magnetic_saturation") ||
      id.starts_with("magnetic_hysteresis") || id.starts_with("magnetic_settling")) {
    const char axis = id.back();
    const auto h = field(axis);
    std::set<long> levels;
    if (h)
      for (const double v : h->value) levels.insert(std::lround(v / 10.0));
    if (levels.size() < 3) return fmt::format("field_{}_ut takes fewer than three levels", axis);
  }
  return {};
}

}  // namespace fogbench::model
