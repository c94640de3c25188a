#include "drivers/open_bench.hpp"

#include "drivers/hid_magnetometer.hpp"
#include "drivers/modbus_thermostat.hpp"
#include "drivers/scpi_coil_supply.hpp"
#include "drivers/serial_gyro.hpp"
#include "drivers/turntables.hpp"

namespace fogbench::drivers {
namespace {

Status check_connected(const char* name, bool connected) {
  if (connected) return {};
  return Error{ErrorCode::kDevice, std::string(name) + ": is not connected to anything"};
}

}  // namespace

Result<Bench> open_bench(const config::BenchConfig& config, Transports transports, Clock& clock,
                         Operator& operator_) {
  for (const Status& connected :
       {check_connected("thermostat", transports.thermostat != nullptr),
        check_connected("coil_horizontal", transports.coil_horizontal != nullptr),
        check_connected("coil_vertical", transports.coil_vertical != nullptr),
        check_connected("magnetometer", transports.magnetometer != nullptr),
        check_connected("turntable",
                        transports.turntable != nullptr || !config.turntable.motorised),
        check_connected("gyro", transports.gyro != nullptr)}) {
    if (!connected) return connected.error();
  }
  Bench bench;

  // The coils first: whatever fails below, they are at 0 A.
  auto horizontal = ScpiCoilSupply::open("coil_horizontal", config.coil_horizontal,
                                         std::move(transports.coil_horizontal), clock);
  if (!horizontal) return horizontal.error();
  bench.coil_horizontal = std::move(*horizontal);

  auto vertical = ScpiCoilSupply::open("coil_vertical", config.coil_vertical,
                                       std::move(transports.coil_vertical), clock);
  if (!vertical) return vertical.error();
  bench.coil_vertical = std::move(*vertical);

  auto thermostat = ModbusThermostat::open("thermostat", config.thermostat.device,
                                           std::move(transports.thermostat), clock);
  if (!thermostat) return thermostat.error();
  bench.thermostat = std::move(*thermostat);

  auto magnetometer = HidMagnetometer::open("magnetometer", config.magnetometer.device,
                                            std::move(transports.magnetometer), clock);
  if (!magnetometer) return magnetometer.error();
  bench.magnetometer = std::move(*magnetometer);

  if (config.turntable.motorised) {
    auto turntable =
        ScpiTurntable::open("turntable", config.turntable, std::move(transports.turntable), clock);
    if (!turntable) return turntable.error();
    bench.turntable = std::move(*turntable);
  } else {
    bench.turntable = std::make_unique<ManualTurntable>("turntable", operator_);
  }

  // The gyro last: it streams from now on, and a line holds little.
  auto gyro = SerialGyro::open("gyro", config.gyro, std::move(transports.gyro), clock);
  if (!gyro) return gyro.error();
  bench.gyro = std::move(*gyro);
  return bench;
}

}  // namespace fogbench::drivers
