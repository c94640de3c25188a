#include "simulator/simulated_bench.hpp"

#include "simulator/far_ends.hpp"

namespace fogbench::simulator {

Result<drivers::Transports> simulate_bench(const config::BenchConfig& config,
                                           const config::ScenarioConfig& scenario,
                                           std::uint64_t seed, drivers::Clock& clock) {
  Result<FarEnds> ends = make_far_ends(config, scenario, seed, clock);
  if (!ends) return ends.error();
  GyroFarEnd* const gyro = ends->gyro.get();
  drivers::Transports transports{.thermostat = std::move(ends->thermostat),
                                 .coil_horizontal = std::move(ends->coil_horizontal),
                                 .coil_vertical = std::move(ends->coil_vertical),
                                 .magnetometer = std::move(ends->magnetometer),
                                 .turntable = std::move(ends->turntable),
                                 .gyro = std::move(ends->gyro),
                                 .auxiliary = {},
                                 .turned_by_hand = {},
                                 .exchange_gyro = [gyro] { gyro->exchange(); }};
  for (AuxiliaryEnd& sensor : ends->auxiliary) {
    std::visit([&](auto& end) { transports.auxiliary.emplace_back(std::move(end)); }, sensor.end);
  }
  if (!config.turntable.motorised) {
    transports.turned_by_hand = [plant = ends->plant](double azimuth_deg) {
      plant->advance();
      plant->turned_to(azimuth_deg);
    };
  }
  return transports;
}

}  // namespace fogbench::simulator
