#include "model/diagnose/shadows.hpp"

#include <fmt/format.h>

#include <cmath>

#include "model/table/moving_signals.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr const char* kTemperatureRate = "temperature_rate_c_per_h";
constexpr int kKinks = 11;             // places of a kink inside a variable's range
constexpr double kLongestPulse = 0.5;  // of the run
constexpr Index kShortRun = 80;
constexpr double kRowsPerWave = 4.0, kWaveRatio = 1.12;
constexpr double kCreepSeconds = 300.0;
constexpr double kNarrowestBell = 1.5, kBellRatio = 1.5;  // rows, of the standard deviation
constexpr double kMostBells = 120.0;                      // of one width
constexpr double kRowsPerSquare = 6.0, kSquareRatio = 1.08;
constexpr int kSquarePhases = 8;  // of half a period

/// `others`: what the field's coefficient may depend on beside the temperature and its rate.
void add_field_shadows(LibraryBuilder& builder, const MovingSignal& h,
                       const std::vector<MovingSignal>& others) {
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
  for (const MovingSignal& other : others) {
    // A product of the catalogue is no shape from outside.
    if (other.name != kTemperatureRate) {
      builder.add_shadow(h.name + " x " + other.name, u.cwiseProduct(other.value));
    }
    builder.add_shadow(h.name + "^2 x " + other.name, u.cwiseAbs2().cwiseProduct(other.value));
  }
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

/// A disturbance that came and went: what bias_step must not be confused with. An edge that misses
/// by a row leaves that row as it was, which in a short run is a large part of the pulse: there
/// every pair of edges is tried. In long ones lengths grow by a ratio, places by a part of them.
void add_pulses(LibraryBuilder& builder) {
  const Signals& signals = builder.signals();
  Candidate pulse{.name = "a temporary pulse in time", .pulse = true};
  const auto add = [&](std::size_t begin, Index from, Index length) {
    VectorXd column = VectorXd::Zero(static_cast<Index>(signals.rows()));
    column.segment(static_cast<Index>(begin) + from, length).setOnes();
    builder.add_block(pulse, builder.averaged(column));
  };
  for (const Signals::RunRange& run : signals.runs()) {
    const auto rows = static_cast<Index>(run.end - run.begin);
    const auto longest = static_cast<Index>(kLongestPulse * static_cast<double>(rows));
    const bool every = rows <= kShortRun;
    for (Index length = every ? 2 : rows / 24 + 1; length <= longest;
         length += every ? 1 : length / 4 + 1) {
      const Index step = every ? 1 : length / 6 + 1;
      for (Index from = step; from + length < rows; from += step) add(run.begin, from, length);
    }
  }
  builder.add(std::move(pulse));
}

/// A disturbance that swells and fades: bells from a few rows to half of the run, so close that one
/// between two of them is nearly both.
void add_bells(LibraryBuilder& builder) {
  const Signals& signals = builder.signals();
  Candidate bell{.name = "a bell-shaped pulse in time", .pulse = true};
  for (const Signals::RunRange& run : signals.runs()) {
    const auto rows = static_cast<double>(run.end - run.begin);
    const Eigen::ArrayXd row =
        Eigen::ArrayXd::LinSpaced(static_cast<Index>(run.end - run.begin), 0.0, rows - 1.0);
    const double narrowest = std::max(kNarrowestBell, rows / kMostBells);
    for (double half = narrowest; half <= rows / 8.0; half *= kBellRatio) {
      for (double at = 0.0; at < rows; at += half) {
        VectorXd column = VectorXd::Zero(static_cast<Index>(signals.rows()));
        column.segment(static_cast<Index>(run.begin), row.size()) =
            (-0.5 * ((row - at) / half).square()).exp();
        builder.add_block(bell, builder.averaged(column), at);
      }
    }
  }
  builder.add(std::move(bell));
}

/// On and off in equal parts: a compressor, a fan, a neighbour's machine.
void add_square_waves(LibraryBuilder& builder, const MovingSignal& time) {
  Candidate wave{.name = "a square wave in time"};
  const double most = static_cast<double>(builder.source().table.rows()) / kRowsPerSquare;
  for (double periods = 1.5; periods < most; periods *= kSquareRatio) {
    for (int step = 0; step < kSquarePhases; ++step) {
      const double phase = M_PI * step / kSquarePhases;
      builder.add_block(
          wave,
          builder.averaged((M_PI * periods * time.scaled.array() + phase).sin().sign().matrix()),
          periods);
    }
  }
  builder.add(std::move(wave));
}

/// Something periodic, an air conditioner say; and what creeps towards rest more slowly than any
/// exponential does.
void add_time_shadows(LibraryBuilder& builder, const MovingSignal& time) {
  Candidate wave{.name = "a wave in time"};
  const double most = static_cast<double>(builder.source().table.rows()) / kRowsPerWave;
  for (double periods = 1.0; periods < most; periods *= kWaveRatio) {
    Eigen::MatrixXd columns(time.value.size(), 2);
    const Eigen::ArrayXd phase = M_PI * periods * time.scaled.array();
    columns << phase.sin().matrix(), phase.cos().matrix();
    builder.add_block(wave, builder.averaged(columns), periods);
  }
  builder.add(std::move(wave));
  builder.add_shadow("time^2", time.scaled.array().square().matrix());
  builder.add_shadow("root of time", time.value.cwiseMax(0.0).cwiseSqrt());
  builder.add_shadow("logarithm of time",
                     (1.0 + time.value.array().max(0.0) / kCreepSeconds).log().matrix());
  add_square_waves(builder, time);
  add_pulses(builder);
  add_bells(builder);
}

}  // namespace

void add_shadows(LibraryBuilder& builder) {
  const Signals& signals = builder.signals();
  const auto excited = [&](std::string_view name) {
    return moving_signal(signals, name, least_excitation(name));
  };
  const auto rate = excited(kTemperatureRate);
  std::vector<MovingSignal> modulating;
  for (const char* name : {kTemperatureRate, "temperature_gradient_c", "time_since_start_s"}) {
    if (auto other = excited(name)) modulating.push_back(std::move(*other));
  }
  for (const char* axis : {"field_x_ut", "field_y_ut", "field_z_ut"}) {
    if (const auto h = excited(axis)) add_field_shadows(builder, *h, modulating);
  }
  if (const auto t = excited("temperature_c")) add_temperature_shadows(builder, *t);
  if (rate) {
    builder.add_shadow("|" + rate->name + "|", rate->value.cwiseAbs());
    builder.add_shadow(rate->name + "^2", rate->value.array().square().matrix());
  }
  if (const auto time = moving_signal(signals, "time_since_start_s")) {
    add_time_shadows(builder, *time);
  }
}

}  // namespace fogbench::model
