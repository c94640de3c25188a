#pragma once
// The simulated bench where a host's own drivers meet it: Modbus TCP and RTU, serial lines, USB by
// USB/IP. In front of the same far ends that a dry run speaks to.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "config/bench.hpp"
#include "config/scenario.hpp"
#include "drivers/clock.hpp"
#include "simulator/far_ends.hpp"
#include "simulator/wire/deferring_clock.hpp"
#include "simulator/wire/event_loop.hpp"
#include "simulator/wire/modbus_unit.hpp"

namespace fogbench::simulator {

struct ServeOptions {
  std::string address = "127.0.0.1";  ///< of this machine, in numbers
  std::uint16_t modbus_port = 0;      ///< 0: any that is free
  std::uint16_t usbip_port = 0;
  std::filesystem::path tty_folder;  ///< exists; the links to the serial lines are made in it
  double speed = 1.0;                ///< bench seconds in one of the machine's
};

/// Where one instrument is met, as benches name it (config/bench.hpp).
struct ServedInstrument {
  std::string name;        ///< "thermostat"
  std::string connection;  ///< "tcp:127.0.0.1:1502"
  std::string also;        ///< a second one, or empty
  std::string bus_id;      ///< of a USB device: what `usbip attach` takes
};

class ServedBench {
 public:
  /// Power-on is now. `machine` must run `options.speed` times as fast as the machine, and outlive
  /// the bench. kBadInput as of make_far_ends, and for two USB devices that nobody could tell
  /// apart; kDevice when an address, a port or a line cannot be had.
  static Result<std::unique_ptr<ServedBench>> open(const config::BenchConfig& config,
                                                   const config::ScenarioConfig& scenario,
                                                   std::uint64_t seed, const ServeOptions& options,
                                                   const drivers::Clock& machine);

  const std::vector<ServedInstrument>& instruments() const { return instruments_; }
  std::uint16_t usbip_port() const { return usbip_port_; }

  /// Serves until `stop` is readable. On one thread, without waiting for anybody.
  Status run(int stop) { return run_event_loop(servers_, clock_, speed_, stop); }

 private:
  ServedBench(const drivers::Clock& machine, double speed) : clock_(machine), speed_(speed) {}
  /// `port` 0: any.
  Status serve_modbus(const std::string& name, const std::string& connection, std::uint8_t unit_id,
                      ModbusFarEnd& far_end, std::uint16_t port, const ServeOptions& options);
  Status serve_usb(const config::BenchConfig& config, const ServeOptions& options);
  Status serve_auxiliary(const config::BenchConfig& config, const ServeOptions& options);
  Status serve_lines(const config::BenchConfig& config, const ServeOptions& options);

  DeferringClock clock_;
  const double speed_;
  FarEnds ends_;
  std::vector<std::unique_ptr<ModbusUnit>> units_;
  std::vector<std::unique_ptr<Server>> servers_;
  std::vector<ServedInstrument> instruments_;
  std::uint16_t usbip_port_ = 0;
};

}  // namespace fogbench::simulator
