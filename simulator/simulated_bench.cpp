#include "simulator/simulated_bench.hpp"

#include "config/roles.hpp"
#include "simulator/far_ends.hpp"

namespace fogbench::simulator {

Result<drivers::Transports> simulate_bench(const config::BenchConfig& config,
                                           const config::ScenarioConfig& scenario,
                                           std::uint64_t seed, drivers::Clock& clock) {
  Result<FarEnds> ends = make_far_ends(config, scenario, seed, clock);
  if (!ends) return ends.error();
  GyroFarEnd* const gyro = ends->gyro.get();
  drivers::Transports transports;
  config::for_each_role([](const char*, auto& way, auto& end) { way = std::move(end); }, transports,
                        *ends);
  transports.exchange_gyro = [gyro] { gyro->exchange(); };
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
