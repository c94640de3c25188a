#pragma once
// Heat in the gyro: the heaters' node, the coil carrier, the fibre coil, and the room.
//
//   C_h dT_h/dt = P(t - dead time) - G_hc (T_h - T_c)
//   C_c dT_c/dt = G_hc (T_h - T_c) - G_ck (T_c - T_k) - G_ca (T_c - T_a)
//   C_k dT_k/dt = G_ck (T_c - T_k)
//   T_a         = mean + wander sin(2 pi t/period)
//
// The heaters' electrical power acts at once on whatever couples to it; its heat reaches the node
// after the dead time.

#include <array>
#include <cstddef>
#include <vector>

#include "config/bench.hpp"

namespace fogbench::simulator {

/// Electrical power of the two kinds of heaters, and what a cooler takes off, W.
struct HeaterPower {
  double boost_w = 0.0;
  double normal_w = 0.0;
  double cooling_w = 0.0;
  double total_w() const { return boost_w + normal_w; }
  double heat_w() const { return total_w() - cooling_w; }
};

class ThermalPhysics {
 public:
  /// Starts in equilibrium with the room. Integrated by Heun's method: over a step of 0.1 s its
  /// error is below 1e-5 of a change.
  ThermalPhysics(const config::ThermalPlant& plant, double step_s);

  /// One step under constant electrical power.
  void advance(const HeaterPower& power);

  double ambient_c() const { return ambient_c_; }
  double heater_c() const { return node_c_[0]; }
  double carrier_c() const { return node_c_[1]; }
  double coil_c() const { return node_c_[2]; }
  double carrier_rate_c_per_h() const { return carrier_rate_c_per_h_; }
  double carrier_acceleration_c_per_h2() const { return carrier_acceleration_c_per_h2_; }
  /// True temperature difference between the places of working sensors 1 and 2.
  double gradient_c() const { return gradient_c_; }

 private:
  using Nodes = std::array<double, 3>;
  Nodes slope_c_per_s(const Nodes& node_c, double ambient_c, double heat_w) const;
  double ambient_at(double time_s) const;

  const config::ThermalPlant plant_;
  const double step_s_;
  std::size_t steps_ = 0;
  std::vector<HeaterPower> delay_;  ///< powers of the last dead time, as a ring
  double ambient_c_;
  Nodes node_c_;
  double carrier_rate_c_per_h_ = 0.0;
  double carrier_acceleration_c_per_h2_ = 0.0;
  double gradient_c_ = 0.0;
};

}  // namespace fogbench::simulator
