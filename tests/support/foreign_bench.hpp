#pragma once
// Measurement tables from a simulator of its own, for trying the diagnosis: neither the bench
// simulator nor the catalogue's code is used, so that a wrong equation cannot confirm itself. True
// states on a grid (foreign_world.hpp), effects on them (foreign_effects.hpp) and noise
// (foreign_noise.hpp) are averaged over the windows; the instruments add their own errors.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "model/table/table.hpp"
#include "tests/support/foreign_effects.hpp"
#include "tests/support/foreign_noise.hpp"
#include "tests/support/foreign_world.hpp"

namespace fogbench::tests {

/// Which columns the bench writes beside time, temperature, fields and azimuth.
struct ForeignColumns {
  bool standard_error = true;
  bool temperature_rate = true;
  bool gradient = true;
  bool heater = true;
  bool ambient = true;
};

/// Const methods may be called on several threads.
class ForeignBench {
 public:
  /// `base`: the effects of the model that the experimenter starts with.
  ForeignBench(Design design, const ForeignNoise& noise, std::vector<std::string> base);

  const std::vector<std::string>& base() const { return base_; }
  const std::vector<World>& worlds() const { return worlds_; }
  Eigen::Index rows() const { return whitened_base_.rows(); }

  /// The effect's mean over each window of all runs.
  Eigen::VectorXd column(const ForeignEffect& effect) const;
  /// L^-1 columns: in units of the true noise.
  Eigen::MatrixXd in_noise(const Eigen::MatrixXd& columns) const;
  /// L^-1 (I - P) columns: in units of the true noise (Omega = L L'), cleared of what the base
  /// model can take up.
  Eigen::MatrixXd clear_in_noise(const Eigen::MatrixXd& columns) const;
  /// |clear_in_noise(column)|: the signal-to-noise ratio s of the effect at its amplitude.
  double signal_to_noise(const ForeignEffect& effect) const;
  /// The effect with its amplitude (sign kept) set for the ratio s.
  /// Precondition: the design excites it.
  ForeignEffect at_ratio(ForeignEffect effect, double s) const;

  /// A table with the base, the hidden effects and fresh noise of rate and instruments.
  model::Table table(const std::vector<ForeignEffect>& hidden, const ForeignColumns& columns,
                     std::uint64_t seed) const;

 private:
  std::vector<World> worlds_;
  ForeignNoise noise_;
  std::vector<std::string> base_;
  Eigen::MatrixXd factor_;         ///< L
  Eigen::MatrixXd whitened_base_;  ///< orthonormal columns that span L^-1 X
};

/// bias, and the linear terms that a first model of the design has.
std::vector<std::string> usual_base(Design design);

/// The gyro of this noise at rest for `hours`, in windows of a minute.
model::Table static_record(const ForeignNoise& noise, double hours, std::uint64_t seed);

}  // namespace fogbench::tests
