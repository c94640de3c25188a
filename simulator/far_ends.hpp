#pragma once
// The far ends of all of a simulated bench's instruments, over one plant.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "config/bench.hpp"
#include "config/scenario.hpp"
#include "simulator/gyro_far_end.hpp"
#include "simulator/hid_far_end.hpp"
#include "simulator/line_far_end.hpp"
#include "simulator/modbus_far_end.hpp"
#include "simulator/scpi_far_end.hpp"

namespace fogbench::simulator {

struct AuxiliaryEnd {
  using End = std::variant<std::unique_ptr<ModbusFarEnd>, std::unique_ptr<ScpiFarEnd>,
                           std::unique_ptr<HidFarEnd>, std::unique_ptr<LineFarEnd>>;
  std::string name;
  End end;
};

/// They share the plant and keep it alive; none may be used from two threads at once.
struct FarEnds {
  std::unique_ptr<ModbusFarEnd> thermostat;
  std::unique_ptr<ScpiFarEnd> coil_horizontal;
  std::unique_ptr<ScpiFarEnd> coil_vertical;
  std::unique_ptr<HidFarEnd> magnetometer;  ///< null where the bench has none
  std::unique_ptr<ScpiFarEnd> turntable;    ///< null where a hand turns the gyro
  std::unique_ptr<GyroFarEnd> gyro;
  std::vector<AuxiliaryEnd> auxiliary;  ///< in the order of the bench
  std::shared_ptr<Plant> plant;         ///< what is true, whatever they say

  /// A fault by hand, from now on until it is switched off. Precondition: the bench has the device.
  void set_fault(std::string_view device, FaultKind kind, bool on);
};

/// As simulate_bench, which puts them behind the drivers' transports. A late answer comes `late_by`
/// after its deadline; with 0 it does not come at all, as for a driver that has stopped waiting.
Result<FarEnds> make_far_ends(const config::BenchConfig& config,
                              const config::ScenarioConfig& scenario, std::uint64_t seed,
                              drivers::Clock& clock, drivers::Clock::Duration late_by = {});

}  // namespace fogbench::simulator
