#include "tests/support/foreign_bench.hpp"

#include <Eigen/Dense>
#include <cassert>
#include <cmath>
#include <map>

namespace fogbench::tests {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// What the base terms add to the rate, deg/h per unit; the bias also stands for what a gyro has.
const std::map<std::string, double>& base_coefficients() {
  static const std::map<std::string, double> all{{"bias", 0.7},
                                                 {"temperature_linear", -0.01},
                                                 {"magnetic_linear_x", -0.05},
                                                 {"magnetic_linear_y", 0.12},
                                                 {"magnetic_linear_z", -0.25}};
  return all;
}

/// Texts stored once each.
class Texts {
 public:
  void push_back(const std::string& text) {
    const auto fresh = static_cast<std::uint32_t>(column_.values.size());
    const auto [known, inserted] = index_.emplace(text, fresh);
    if (inserted) column_.values.push_back(text);
    column_.index.push_back(known->second);
  }
  model::TextColumn finish() { return std::move(column_); }

 private:
  model::TextColumn column_;
  std::map<std::string, std::uint32_t> index_;
};

/// Writes down what the bench's instruments say of each window.
class Recorder {
 public:
  Recorder(const ForeignNoise& noise, const ForeignColumns& columns, std::mt19937_64& engine)
      : noise_(noise), columns_(columns), engine_(engine) {}

  void row(const World& world, const World::Window& window, double rate_deg_per_h,
           const std::string& run) {
    put("rate_deg_per_h", rate_deg_per_h);
    put("time_s", 0.5 * static_cast<double>(window.begin + window.end) * kGridStep);
    put("duration_s", window.seconds());
    if (columns_.standard_error) {
      put("rate_std_error_deg_per_h", white_deviation(noise_, world, window) * (1.0 + error(0.05)));
    }
    put("temperature_c", world.mean(world.temperature_c, window) + error(0.001));
    if (columns_.temperature_rate) {
      // The slope between the window's ends, from a sensor of a millikelvin.
      const double change = world.temperature_c[window.end - 1] - world.temperature_c[window.begin];
      put("temperature_rate_c_per_h",
          change * 3600.0 / (window.seconds() - kGridStep) + error(0.03));
    }
    if (columns_.gradient) {
      put("temperature_gradient_c", world.mean(world.gradient_c, window) + error(0.002));
    }
    if (columns_.ambient) put("ambient_c", world.mean(world.ambient_c, window) + error(0.01));
    if (columns_.heater) put("heater_w", world.mean(world.heater_w, window));
    put("field_x_ut", world.mean(world.field_ut[0], window) + error(0.01));
    put("field_y_ut", world.mean(world.field_ut[1], window) + error(0.01));
    put("field_z_ut", world.mean(world.field_ut[2], window) + error(0.01));
    put("azimuth_deg", world.mean(world.azimuth_deg, window));
    segments_.push_back(window.segment);
    runs_.push_back(run);
  }

  model::Table finish() {
    model::Table table;
    for (auto& [name, values] : values_) table.set_column(name, std::move(values));
    table.set_segment(segments_.finish());
    table.set_run(runs_.finish());
    return table;
  }

 private:
  void put(const char* name, double value) { values_[name].push_back(value); }
  double error(double deviation) { return deviation * normal_(engine_); }

  const ForeignNoise& noise_;
  const ForeignColumns& columns_;
  std::mt19937_64& engine_;
  std::normal_distribution<> normal_;
  std::map<std::string, std::vector<double>> values_;
  Texts segments_, runs_;
};

}  // namespace

ForeignBench::ForeignBench(Design design, const ForeignNoise& noise, std::vector<std::string> base)
    : worlds_(make_worlds(design)), noise_(noise), base_(std::move(base)) {
  std::size_t rows = 0;
  for (const World& world : worlds_) rows += world.windows.size();
  MatrixXd covariance = MatrixXd::Zero(static_cast<Index>(rows), static_cast<Index>(rows));
  Index at = 0;
  for (const World& world : worlds_) {
    const MatrixXd block = noise_covariance(noise_, world);
    covariance.block(at, at, block.rows(), block.cols()) = block;
    at += block.rows();
  }
  const Eigen::LLT<MatrixXd> factor(covariance);
  assert(factor.info() == Eigen::Success);
  factor_ = factor.matrixL();
  MatrixXd x(static_cast<Index>(rows), static_cast<Index>(base_.size()));
  for (Index j = 0; j < x.cols(); ++j) {
    x.col(j) = column({.id = base_[static_cast<std::size_t>(j)]});
  }
  x = in_noise(x);
  whitened_base_ =
      Eigen::HouseholderQR<MatrixXd>(x).householderQ() * MatrixXd::Identity(x.rows(), x.cols());
}

VectorXd ForeignBench::column(const ForeignEffect& effect) const {
  std::vector<double> out;
  for (const World& world : worlds_) {
    const Series g = regressor(world, effect);
    for (const World::Window& w : world.windows) out.push_back(effect.amplitude * world.mean(g, w));
  }
  return Eigen::Map<const VectorXd>(out.data(), static_cast<Index>(out.size()));
}

MatrixXd ForeignBench::in_noise(const MatrixXd& columns) const {
  return factor_.triangularView<Eigen::Lower>().solve(columns);
}

MatrixXd ForeignBench::clear_in_noise(const MatrixXd& columns) const {
  MatrixXd out = in_noise(columns);
  out -= whitened_base_ * (whitened_base_.transpose() * out).eval();
  return out;
}

double ForeignBench::signal_to_noise(const ForeignEffect& effect) const {
  return clear_in_noise(column(effect)).norm();
}

ForeignEffect ForeignBench::at_ratio(ForeignEffect effect, double s) const {
  const double now = signal_to_noise(effect);
  assert(now > 0.0);
  effect.amplitude *= s / now;
  return effect;
}

model::Table ForeignBench::table(const std::vector<ForeignEffect>& hidden,
                                 const ForeignColumns& columns, std::uint64_t seed) const {
  std::mt19937_64 engine(seed);
  VectorXd rate = VectorXd::Zero(rows());
  for (const std::string& id : base_) {
    rate += column({.id = id, .amplitude = base_coefficients().at(id)});
  }
  for (const ForeignEffect& effect : hidden) rate += column(effect);
  Recorder recorder(noise_, columns, engine);
  Index row = 0;
  for (std::size_t run = 0; run < worlds_.size(); ++run) {
    const World& world = worlds_[run];
    const VectorXd noise = draw_noise(noise_, world, engine);
    for (Index i = 0; i < noise.size(); ++i, ++row) {
      recorder.row(world, world.windows[static_cast<std::size_t>(i)], rate[row] + noise[i],
                   std::to_string(run + 1));
    }
  }
  return recorder.finish();
}

std::vector<std::string> usual_base(Design design) {
  std::vector<std::string> out{"bias"};
  const bool thermal = design == Design::kPlateaus || design == Design::kThermal ||
                       design == Design::kThermalCooling || design == Design::kMixed ||
                       design == Design::kLong;
  const bool magnetic = design == Design::kMagnetic || design == Design::kDiagonals ||
                        design == Design::kMixed || design == Design::kLong ||
                        design == Design::kTwoRuns;
  if (thermal) out.emplace_back("temperature_linear");
  if (magnetic) {
    out.insert(out.end(), {"magnetic_linear_x", "magnetic_linear_y", "magnetic_linear_z"});
  }
  if (design == Design::kOneAxis) out.emplace_back("magnetic_linear_z");
  return out;
}

model::Table static_record(const ForeignNoise& noise, double hours, std::uint64_t seed) {
  World world;
  const auto steps = static_cast<std::size_t>(hours * 3600.0 / kGridStep);
  constexpr std::size_t kStepsPerWindow = 6;
  world.temperature_c.assign(steps, kLaboratory);
  for (std::size_t at = 0; at + kStepsPerWindow <= steps; at += kStepsPerWindow) {
    world.windows.push_back({at, at + kStepsPerWindow, "static"});
  }
  for (Series* series :
       {&world.rate_c_per_h, &world.gradient_c, &world.heater_w, &world.azimuth_deg,
        &world.field_ut[0], &world.field_ut[1], &world.field_ut[2]}) {
    series->assign(steps, 0.0);
  }
  world.ambient_c.assign(steps, kLaboratory);
  std::mt19937_64 engine(seed);
  const ForeignColumns columns;
  const VectorXd drawn = draw_noise(noise, world, engine);
  Recorder recorder(noise, columns, engine);
  for (Index i = 0; i < drawn.size(); ++i) {
    recorder.row(world, world.windows[static_cast<std::size_t>(i)],
                 base_coefficients().at("bias") + drawn[i], "1");
  }
  return recorder.finish();
}

}  // namespace fogbench::tests
