#include "drivers/open_bench.hpp"

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "config/roles.hpp"
#include "drivers/auxiliary_sensor.hpp"
#include "drivers/hid_magnetometer.hpp"
#include "drivers/modbus_thermostat.hpp"
#include "drivers/reckoned_field.hpp"
#include "drivers/scpi_coil_supply.hpp"
#include "drivers/serial_gyro.hpp"
#include "drivers/turntables.hpp"

namespace fogbench::drivers {
namespace {

/// Moves what was attached to its place in the bench.
template <class Driver, class Place>
Status take(Result<std::unique_ptr<Driver>> attached, Place& place) {
  if (!attached) return attached.error();
  place = std::move(*attached);
  return {};
}

}  // namespace

Result<Bench> attach_bench(const config::BenchConfig& config, Transports transports, Clock& clock,
                           Operator& operator_) {
  Status connected;
  config::for_each_role(
      [&](const char* role, const auto& transport, const auto& its) {
        if (!connected || transport != nullptr || config::device_of(its) == nullptr) return;
        connected = Error{ErrorCode::kDevice, std::string(role) + ": is not connected to anything"};
      },
      transports, config);
  if (!connected) return connected.error();
  Bench bench;
  Status status = take(ScpiCoilSupply::attach("coil_horizontal", config.coil_horizontal,
                                              std::move(transports.coil_horizontal), clock),
                       bench.coil_horizontal);
  if (status) {
    status = take(ScpiCoilSupply::attach("coil_vertical", config.coil_vertical,
                                         std::move(transports.coil_vertical), clock),
                  bench.coil_vertical);
  }
  if (status) {
    status = take(ModbusThermostat::attach("thermostat", config.thermostat.device,
                                           std::move(transports.thermostat), clock),
                  bench.thermostat);
  }
  if (status && config.turntable.motorised) {
    status = take(ScpiTurntable::attach("turntable", config.turntable,
                                        std::move(transports.turntable), clock),
                  bench.turntable);
  } else {
    bench.turntable = std::make_unique<ManualTurntable>("turntable", operator_,
                                                        std::move(transports.turned_by_hand));
  }
  if (status && config.magnetometer.fitted) {
    status = take(HidMagnetometer::attach("magnetometer", config.magnetometer.device,
                                          std::move(transports.magnetometer), clock),
                  bench.magnetometer);
  } else if (status) {
    bench.magnetometer = std::make_unique<ReckonedField>(
        config, *bench.coil_horizontal, *bench.coil_vertical, *bench.turntable, clock);
  }
  if (status) {
    status = take(SerialGyro::attach("gyro", config.gyro, std::move(transports.gyro), clock),
                  bench.gyro);
  }
  if (!status) return status.error();
  if (transports.auxiliary.size() != config.auxiliary.size()) {
    return Error{ErrorCode::kDevice, "auxiliary: not every sensor is connected to something"};
  }
  for (std::size_t i = 0; i < config.auxiliary.size(); ++i) {
    auto sensor = attach_sensor(config.auxiliary[i], std::move(transports.auxiliary[i]), clock);
    if (!sensor) return sensor.error();
    bench.auxiliary.push_back(std::move(*sensor));
  }
  return bench;
}

Status begin_bench(const Bench& bench) {
  std::optional<Error> failure;
  // The coils first. The gyro last: it streams from then on, and a line holds little.
  for (Instrument* instrument : {static_cast<Instrument*>(bench.coil_horizontal.get()),
                                 static_cast<Instrument*>(bench.coil_vertical.get()),
                                 static_cast<Instrument*>(bench.thermostat.get()),
                                 static_cast<Instrument*>(bench.magnetometer.get()),
                                 static_cast<Instrument*>(bench.turntable.get()),
                                 static_cast<Instrument*>(bench.gyro.get())}) {
    const Status begun = instrument->begin();
    if (begun) continue;
    if (failure) {
      failure->message += "; " + begun.error().message;
    } else {
      failure = begun.error();
    }
  }
  return failure ? Status(*failure) : Status{};
}

Result<Bench> open_bench(const config::BenchConfig& config, Transports transports, Clock& clock,
                         Operator& operator_) {
  auto bench = attach_bench(config, std::move(transports), clock, operator_);
  if (!bench) return bench;
  if (const Status begun = begin_bench(*bench); !begun) return begun.error();
  return bench;
}

}  // namespace fogbench::drivers
