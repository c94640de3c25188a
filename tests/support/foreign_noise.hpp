#pragma once
// The noise of the foreign bench: drawn as paths in time, and its exact covariance in closed form,
// so that an effect can be put in at a stated signal-to-noise ratio. Some kinds belong to the
// family that the analysis fits (white, flicker, random walk), some do not.

#include <Eigen/Core>
#include <random>
#include <string>
#include <vector>

#include "tests/support/foreign_world.hpp"

namespace fogbench::tests {

struct ForeignNoise {
  double white = 0.0;    ///< deg/sqrt(h)
  double flicker = 0.0;  ///< deg/h, bias instability
  double walk = 0.0;     ///< deg/h/sqrt(h)
  // Not of the fitted family:
  double fractional = 0.0;  ///< deg/h in a step, spectrum 1/f^1.5
  double markov = 0.0;      ///< deg/h, one Ornstein-Uhlenbeck process
  double markov_tau_s = 900.0;
  double interference = 0.0;  ///< deg/h, amplitude of a sine in time with an unknown phase
  double interference_period_s = 700.0;
  double tails = 0.0;        ///< degrees of freedom of the white part; 0: normal
  double white_swing = 0.0;  ///< the white level changes slowly by this share, once a run
  // The white level of single windows, which their stated errors know.
  double poor_rows = 1.0;    ///< times the usual, in a fifth of the windows
  double poor_third = 1.0;   ///< times the usual, in the last third of the run
  double poor_field = 0.0;   ///< more by this share for each 100 uT
  double quantum_deg = 0.0;  ///< resolution of the angle output
};

/// "white", "flicker", "walk", "navigation", "tactical"; outside the fitted family "fractional",
/// "markov", "interference", "tails", "heavy_tails", "swing", "quantised"; white with errors that
/// differ by row "poor_rows", "poor_third", "poor_field". Precondition: one of them.
ForeignNoise foreign_noise(const std::string& name);
std::vector<std::string> noises_of_the_family();
std::vector<std::string> noises_outside_the_family();
std::vector<std::string> noises_that_differ_by_row();

/// Standard deviation of the white part of a window, deg/h.
double white_deviation(const ForeignNoise& noise, const World& world, const World::Window& window);

/// Mean of the noise over each window of a run.
Eigen::VectorXd draw_noise(const ForeignNoise& noise, const World& world, std::mt19937_64& engine);

/// The covariance of these means.
Eigen::MatrixXd noise_covariance(const ForeignNoise& noise, const World& world);

}  // namespace fogbench::tests
