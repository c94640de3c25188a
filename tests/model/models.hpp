#pragma once
// Models and tables that several tests of model/ ask about.

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "config/model_file.hpp"
#include "model/table/table.hpp"
#include "tests/model/noise_generator.hpp"

namespace fogbench::model {

/// A term whose coefficient is to be fitted.
inline config::ModelTerm term(std::string effect) {
  config::ModelTerm out;
  out.effect = std::move(effect);
  return out;
}

/// A term of a known coefficient.
inline config::ModelTerm term(std::string effect, double coefficient) {
  config::ModelTerm out = term(std::move(effect));
  out.coefficient = coefficient;
  return out;
}

/// The model of these terms.
inline config::ModelFile model_of(std::vector<config::ModelTerm> terms,
                                  std::string observable = "rate_deg_per_h") {
  config::ModelFile out;
  out.observable = std::move(observable);
  out.terms = std::move(terms);
  return out;
}

/// The model of these effects, every coefficient to be fitted.
inline config::ModelFile model_of_effects(const std::vector<std::string>& effects) {
  config::ModelFile out;
  for (const std::string& effect : effects) out.terms.push_back(term(effect));
  return out;
}

/// config/data/paper-thermal.csv: set points, deviations from the unheated baseline, sigmas.
inline Table published_thermal() {
  Table table;
  table.set_column("temperature_c", {31, 35, 40, 45, 50, 55});
  table.set_column("rate_deg_per_h", {0.489, 0.346, 0.498, 0.540, 0.919, 1.564});
  table.set_column("sigma_deg_per_h", {0.081, 0.051, 0.051, 0.043, 0.043, 0.019});
  return table;
}

/// A field along z in loops of 25 windows of 180 s every 200 s: bias, slope and the given noise;
/// `gap` is added on the way down.
inline Table noisy_loops(const NoiseCoefficients& noise, unsigned seed, int loops, double gap) {
  const int rows = 25 * loops;
  NoiseGenerator generator(noise, 20.0, 200.0 * rows, seed);
  std::vector<double> rate, field, time, duration(static_cast<std::size_t>(rows), 180.0), error;
  TextColumn segment{.values = {"coil_z/up", "coil_z/down"}, .index = {}};
  for (int i = 0; i < rows; ++i) {
    const int k = i % 25;
    const double level = 50.0 * (k <= 6 ? k : k <= 18 ? 12 - k : k - 24);
    const bool down = k > 6 && k <= 18;
    field.push_back(level);
    segment.index.push_back(down ? 1 : 0);
    rate.push_back(0.5 + 0.25 * level / 100.0 + (down ? gap : 0.0) + generator.mean_of(9));
    generator.next();
    time.push_back(90.0 + 200.0 * i);
    error.push_back(noise.angle_random_walk_deg_per_sqrt_h / std::sqrt(0.05));
  }
  Table table;
  table.set_column("rate_deg_per_h", rate);
  table.set_column("field_z_ut", field);
  table.set_column("time_s", time);
  table.set_column("duration_s", duration);
  table.set_column("rate_std_error_deg_per_h", error);
  table.set_segment(segment);
  return table;
}

}  // namespace fogbench::model
