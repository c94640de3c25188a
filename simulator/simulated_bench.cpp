#include "simulator/simulated_bench.hpp"

#include "simulator/far_ends.hpp"

namespace fogbench::simulator {

Result<drivers::Transports> simulate_bench(const config::BenchConfig& config,
                                           const config::ScenarioConfig& scenario,
                                           std::uint64_t seed, drivers::Clock& clock) {
  Result<FarEnds> ends = make_far_ends(config, scenario, seed, clock);
  if (!ends) return ends.error();
  drivers::Transports transports{.thermostat = std::move(ends->thermostat),
                                 .coil_horizontal = std::move(ends->coil_horizontal),
                                 .coil_vertical = std::move(ends->coil_vertical),
                                 .magnetometer = std::move(ends->magnetometer),
                                 .turntable = std::move(ends->turntable),
                                 .gyro = std::move(ends->gyro)};
  for (AuxiliaryEnd& sensor : ends->auxiliary) {
    std::visit([&](auto& end) { transports.auxiliary.emplace_back(std::move(end)); }, sensor.end);
  }
  return transports;
}

}  // namespace fogbench::simulator
