#include <fmt/format.h>

#include <cmath>

#include "model/diagnose/library_builder.hpp"
#include "model/diagnose/moving_signals.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kPulsePlaces = 20;  // edges that a temporary pulse may start or end at
constexpr int kKinks = 5;         // places of a kink inside a variable's range

void add_field_shadows(LibraryBuilder& builder, const MovingSignal& h,
                       const std::optional<MovingSignal>& rate) {
  const VectorXd u = h.value / kFieldUnitUt;
  const VectorXd size = u.cwiseAbs();
  const VectorXd going = direction(builder.signals(), h.value);
  builder.add_shadow("|" + h.name + "|", size);
  builder.add_shadow("sqrt|" + h.name + "|", size.cwiseSqrt());
  builder.add_shadow("sign of " + h.name, u.array().sign().matrix());
  builder.add_shadow(h.name + " where positive", u.cwiseMax(0.0));
  builder.add_shadow(h.name + "^3", u.array().cube().matrix());
  builder.add_shadow("|" + h.name + "|^3", size.array().cube().matrix());
  builder.add_shadow(h.name + "^4", u.array().pow(4).matrix());
  builder.add_shadow("direction of the sweep x " + h.name, going.cwiseProduct(u));
  builder.add_shadow("direction of the sweep x |" + h.name + "|", going.cwiseProduct(size));
  builder.add_shadow("direction of the sweep x " + h.name + "^3",
                     going.cwiseProduct(u.array().cube().matrix()));
  if (rate) builder.add_shadow(h.name + " x " + rate->name, u.cwiseProduct(rate->value));
  Candidate wave{.name = "sine of " + h.name};
  for (const double periods : {1.0, 1.5, 2.0, 2.5, 3.0, 4.0}) {
    Eigen::MatrixXd columns(u.size(), 2);
    const Eigen::ArrayXd phase = M_PI * periods * h.scaled.array();
    columns << phase.sin().matrix(), phase.cos().matrix();
    builder.add_block(wave, builder.averaged(columns), periods);
  }
  builder.add(std::move(wave));
}

void add_temperature_shadows(LibraryBuilder& builder, const MovingSignal& t) {
  Candidate kink{.name = "a kink in " + t.name};
  for (int i = 1; i <= kKinks; ++i) {
    const double at = -1.0 + 2.0 * i / (kKinks + 1.0);
    builder.add_block(kink, builder.averaged((t.scaled.array() - at).max(0.0).matrix()), at);
  }
  builder.add(std::move(kink));
  builder.add_shadow(t.name + "^4", t.scaled.array().pow(4).matrix());
  builder.add_shadow("direction of heating", direction(builder.signals(), t.value));
}

/// A disturbance that came and went: what bias_step must not be confused with.
void add_pulses(LibraryBuilder& builder) {
  const Signals& signals = builder.signals();
  Candidate pulse{.name = "a temporary pulse in time"};
  for (const Signals::RunRange& run : signals.runs()) {
    const std::size_t length = run.end - run.begin;
    for (std::size_t from = 1; from < kPulsePlaces; ++from) {
      for (std::size_t to = from + 1; to < kPulsePlaces; ++to) {
        VectorXd column = VectorXd::Zero(static_cast<Index>(signals.rows()));
        const std::size_t first = run.begin + length * from / kPulsePlaces;
        const std::size_t last = run.begin + length * to / kPulsePlaces;
        column.segment(static_cast<Index>(first), static_cast<Index>(last - first)).setOnes();
        builder.add_block(pulse, builder.averaged(column));
      }
    }
  }
  builder.add(std::move(pulse));
}

}  // namespace

void add_shadows(LibraryBuilder& builder) {
  const Signals& signals = builder.signals();
  const auto excited = [&](std::string_view name) {
    return moving_signal(signals, name, least_excitation(name));
  };
  const auto rate = excited("temperature_rate_c_per_h");
  for (const char* axis : {"field_x_ut", "field_y_ut", "field_z_ut"}) {
    if (const auto h = excited(axis)) add_field_shadows(builder, *h, rate);
  }
  if (const auto t = excited("temperature_c")) add_temperature_shadows(builder, *t);
  if (rate) {
    builder.add_shadow("|" + rate->name + "|", rate->value.cwiseAbs());
    builder.add_shadow(rate->name + "^2", rate->value.array().square().matrix());
  }
  if (const auto time = moving_signal(signals, "time_since_start_s")) {
    builder.add_shadow("time^2", time->scaled.array().square().matrix());
    add_pulses(builder);
  }
}

}  // namespace fogbench::model
