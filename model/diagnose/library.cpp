#include "model/diagnose/library.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "model/diagnose/bins.hpp"
#include "model/diagnose/shapes.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kGridPoints = 20;       // of an inner parameter
constexpr int kMostJumpPlaces = 120;  // of an instant
constexpr int kPulsePlaces = 14;      // edges that a temporary pulse may start or end at

/// Appends blocks of columns while a library is built.
class Builder {
 public:
  explicit Builder(Index rows) : rows_(rows) {}

  void add_block(Candidate& candidate, const MatrixXd& columns, std::vector<double> inner) {
    if (!columns.allFinite() || columns.cwiseAbs().maxCoeff() == 0.0) return;
    candidate.blocks.push_back({.first = count_, .width = columns.cols(), .inner = std::move(inner)});
    parts_.push_back(columns);
    count_ += columns.cols();
  }

  void add_shadow(std::string name, const MatrixXd& columns) {
    Candidate shadow{.name = std::move(name), .shadow = true, .blocks = {}};
    add_block(shadow, columns, {});
    if (!shadow.blocks.empty()) library.candidates.push_back(std::move(shadow));
  }

  Library finish() {
    library.columns.resize(rows_, count_);
    Index at = 0;
    for (const MatrixXd& part : parts_) {
      library.columns.middleCols(at, part.cols()) = part;
      at += part.cols();
    }
    return std::move(library);
  }

  Library library;

 private:
  Index rows_;
  Index count_ = 0;
  std::vector<MatrixXd> parts_;
};

bool is_slow(std::string_view id) {
  return id == "drift_linear" || id == "warm_up" || id == "bias_step" ||
         id == "ambient_temperature" || id == "coil_heating";
}

/// Instants at which a jump can be told from its neighbours: the middles between rows.
std::vector<double> jump_places(const Signals& signals) {
  std::vector<double> out;
  const auto time = signals.signal("time_s");
  for (const Signals::RunRange& run : signals.runs()) {
    for (std::size_t i = run.begin + 2; i + 1 < run.end; ++i) {
      const auto k = static_cast<Index>(i);
      out.push_back(0.5 * (time[k - 1] + time[k]));
    }
  }
  const std::size_t step = out.size() / kMostJumpPlaces + 1;
  std::vector<double> thinned;
  for (std::size_t i = 0; i < out.size(); i += step) thinned.push_back(out[i]);
  return thinned;
}

std::vector<double> grid_of(const InnerParameter& parameter, const EffectInfo& info,
                            const Signals& signals) {
  if (parameter.name == "t0") return jump_places(signals);
  double least = parameter.minimum, most = parameter.maximum;
  if (info.id == "temperature_ripple") {
    // More than one period must lie inside the range, or it is a polynomial.
    const auto t = moving_signal(signals, "temperature_c");
    if (t) most = std::min(most, t->span() / 1.2);
    if (most <= least) return {};
  }
  const int points = info.id == "temperature_ripple" ? 2 * kGridPoints : kGridPoints;
  std::vector<double> out;
  for (int i = 0; i < points; ++i) {
    const double t = static_cast<double>(i) / (points - 1);
    out.push_back(parameter.logarithmic && least > 0.0 ? least * std::pow(most / least, t)
                                                       : least + t * (most - least));
  }
  return out;
}

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

/// Why the effect cannot show in these data although its signals are there; empty when it can.
std::string unexcited_because(const EffectInfo& info, const Signals& signals) {
  const std::string_view id = info.id;
  const auto field = [&](char axis) {
    const std::string name = fmt::format("field_{}_ut", axis);
    return moving_signal(signals, name, least_excitation(name));
  };
  if (id.starts_with("magnetic_cross_")) {
    const auto a = field(id[15]), b = field(id[16]);
    const std::string never = fmt::format("field_{}_ut and field_{}_ut are never energised together",
                                          id[15], id[16]);
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
    if (t) for (const double v : t->value) plateaus.insert(std::lround(v));
    if (plateaus.size() < 8) return "temperature_c takes too few values to show a period";
  }
  if (id.starts_with("magnetic_quadratic") || id.starts_with("magnetic_saturation") ||
      id.starts_with("magnetic_hysteresis") || id.starts_with("magnetic_settling")) {
    const char axis = id.back();
    const auto h = field(axis);
    std::set<long> levels;
    if (h) for (const double v : h->value) levels.insert(std::lround(v / 10.0));
    if (levels.size() < 3) return fmt::format("field_{}_ut takes fewer than three levels", axis);
  }
  return {};
}

void add_effect(Builder& builder, const Effect& effect, const Signals& signals) {
  const EffectInfo& info = effect.info();
  const auto refuse = [&](std::string because) {
    builder.library.not_testable.push_back({std::string(info.id), std::move(because)});
  };
  const auto missing = signals.missing_for(info);
  if (!missing.empty()) {
    return refuse(fmt::format("the table has no {}", fmt::join(missing, ", ")));
  }
  if (std::string because = unexcited_because(info, signals); !because.empty()) {
    return refuse(std::move(because));
  }
  Candidate candidate{.name = std::string(info.id), .effect = &effect, .slow = is_slow(info.id), .blocks = {}};
  if (info.parameters.empty()) {
    builder.add_block(candidate, finite_regressor(effect, signals, {}), {});
  } else {
    for (const double value : grid_of(info.parameters.front(), info, signals)) {
      const std::vector<double> inner{value};
      builder.add_block(candidate, finite_regressor(effect, signals, inner), inner);
    }
  }
  if (candidate.blocks.empty()) return refuse("the effect is zero everywhere in these data");
  builder.library.candidates.push_back(std::move(candidate));
}

void add_field_shadows(Builder& builder, const Signals& signals, const MovingSignal& h,
                       const std::optional<MovingSignal>& rate) {
  const VectorXd u = h.value / 100.0;
  const VectorXd going = direction(signals, h.value);
  builder.add_shadow("|" + h.name + "|", u.cwiseAbs());
  builder.add_shadow("sqrt|" + h.name + "|", u.cwiseAbs().cwiseSqrt());
  builder.add_shadow(h.name + " where positive", u.cwiseMax(0.0));
  builder.add_shadow("direction of the sweep x " + h.name, going.cwiseProduct(u));
  builder.add_shadow("|" + h.name + "|^3", u.cwiseAbs().array().cube().matrix());
  builder.add_shadow(h.name + "^4", u.array().pow(4).matrix());
  if (rate) builder.add_shadow(h.name + " x " + rate->name, u.cwiseProduct(rate->value));
}

/// A disturbance that came and went: what bias_step must not be confused with.
void add_pulses(Builder& builder, const Signals& signals) {
  Candidate pulse{.name = "a temporary pulse in time", .shadow = true, .blocks = {}};
  for (const Signals::RunRange& run : signals.runs()) {
    const std::size_t length = run.end - run.begin;
    for (int from = 0; from < kPulsePlaces; ++from) {
      for (int to = from + 1; to <= kPulsePlaces; ++to) {
        if (from == 0 || to == kPulsePlaces) continue;  // those are steps
        VectorXd column = VectorXd::Zero(static_cast<Index>(signals.rows()));
        const auto first = run.begin + length * static_cast<std::size_t>(from) / kPulsePlaces;
        const auto last = run.begin + length * static_cast<std::size_t>(to) / kPulsePlaces;
        column.segment(static_cast<Index>(first), static_cast<Index>(last - first)).setOnes();
        builder.add_block(pulse, column, {});
      }
    }
  }
  if (!pulse.blocks.empty()) builder.library.candidates.push_back(std::move(pulse));
}

void add_shadows(Builder& builder, const Signals& signals) {
  const auto rate = moving_signal(signals, "temperature_rate_c_per_h",
                                  least_excitation("temperature_rate_c_per_h"));
  const auto temperature = moving_signal(signals, "temperature_c", least_excitation("temperature_c"));
  for (const char* axis : {"field_x_ut", "field_y_ut", "field_z_ut"}) {
    if (const auto h = moving_signal(signals, axis, least_excitation(axis))) {
      add_field_shadows(builder, signals, *h, rate);
    }
  }
  if (temperature) {
    const VectorXd t = temperature->scaled;
    builder.add_shadow("temperature_c above its middle", t.cwiseMax(0.0));
    builder.add_shadow("temperature_c^4", t.array().pow(4).matrix());
    builder.add_shadow("direction of heating", direction(signals, temperature->value));
  }
  if (rate) {
    builder.add_shadow("|" + rate->name + "|", rate->value.cwiseAbs());
    builder.add_shadow(rate->name + "^2", rate->value.array().square().matrix());
  }
  if (const auto time = moving_signal(signals, "time_since_start_s")) {
    builder.add_shadow("time^2", time->scaled.array().square().matrix());
    add_pulses(builder, signals);
  }
}

}  // namespace

MatrixXd finite_regressor(const Effect& effect, const Signals& signals,
                          std::span<const double> inner) {
  MatrixXd out = effect.regressor(signals, inner);
  out = out.array().isFinite().select(out, 0.0).eval();
  // A static record informs the noise only.
  if (signals.available(kQuietColumn)) {
    out.array().colwise() *= 1.0 - signals.signal(kQuietColumn).array();
  }
  return out;
}

Library make_library(const Signals& signals, const config::ModelFile& model) {
  Builder builder(static_cast<Index>(signals.rows()));
  for (const Effect* effect : catalogue()) {
    const bool present =
        std::any_of(model.terms.begin(), model.terms.end(), [&](const config::ModelTerm& term) {
          return !term.expression && term.effect == effect->info().id;
        });
    if (!present) add_effect(builder, *effect, signals);
  }
  add_shadows(builder, signals);
  return builder.finish();
}

Library make_smooth_library(const Signals& signals) {
  Builder builder(static_cast<Index>(signals.rows()));
  const auto moving = moving_signals(signals);
  constexpr int kDegree = 6;
  for (const MovingSignal& a : moving) {
    Candidate one{.name = a.name, .shadow = true, .blocks = {}};
    for (const int degree : {3, kDegree}) {
      builder.add_block(one, legendre(a.scaled, degree), {});
    }
    const VectorXd going = direction(signals, a.value);
    if (a.name != "time_since_start_s" && going.minCoeff() < 0.0) {
      const MatrixXd shape = legendre(a.scaled, 3);
      MatrixXd loop(shape.rows(), 4);
      loop << going, going.asDiagonal() * shape;
      Candidate history{.name = "history of " + a.name, .shadow = true, .blocks = {}};
      builder.add_block(history, loop, {});
      if (!history.blocks.empty()) builder.library.candidates.push_back(std::move(history));
    }
    if (!one.blocks.empty()) builder.library.candidates.push_back(std::move(one));
  }
  for (std::size_t i = 0; i < moving.size(); ++i) {
    for (std::size_t j = i + 1; j < moving.size(); ++j) {
      Candidate pair{.name = moving[i].name + " x " + moving[j].name, .shadow = true, .blocks = {}};
      builder.add_block(pair, moving[i].scaled.cwiseProduct(moving[j].scaled), {});
      if (!pair.blocks.empty()) builder.library.candidates.push_back(std::move(pair));
    }
  }
  return builder.finish();
}

}  // namespace fogbench::model
