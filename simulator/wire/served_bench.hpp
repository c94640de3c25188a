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
#include "simulator/wire/usbip_server.hpp"

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
  Status run(int stop) { return run_event_loop(servers_, clock_, options_.speed, stop); }

  /// For who stands beside the bench: what is behind the wires, the clock that it goes by, and a
  /// server more in its loop.
  FarEnds& far_ends() { return ends_; }
  const drivers::Clock& clock() const { return clock_; }
  void add(std::unique_ptr<Server> server) { servers_.push_back(std::move(server)); }

 private:
  ServedBench(const drivers::Clock& machine, const ServeOptions& options)
      : clock_(machine), options_(options) {}

  Status serve(const config::BenchConfig& config);
  template <class Device>
  Status serve(const config::AuxiliaryConfig& sensor, const Device& device, AuxiliaryEnd::End& end);
  /// Modbus: over TCP at `port`, 0: any, and on a serial line.
  Status serve_registers(const std::string& name, const config::InstrumentConfig& its,
                         std::uint8_t unit_id, ModbusFarEnd& far_end, std::uint16_t port);
  /// SCPI: on USB or a serial line, as the bench connects it; `usual` where it does not say.
  Status serve_messages(const std::string& name, const config::InstrumentConfig& its,
                        const std::string& product, const std::string& usual, ScpiFarEnd& far_end);
  Status serve_reports(const std::string& name, const config::InstrumentConfig& its,
                       const config::HidDevice& layout, HidFarEnd& far_end);
  template <class LineServing, class FarEnd, class... Rest>
  Status serve_line(const std::string& name, FarEnd& far_end, Rest&&... rest);
  Status serve_usb(const std::string& name, const char* scheme, std::unique_ptr<UsbDevice> device);

  DeferringClock clock_;
  const ServeOptions options_;
  FarEnds ends_;
  std::vector<std::unique_ptr<ModbusUnit>> units_;
  std::vector<ExportedDevice> usb_devices_;
  std::vector<std::unique_ptr<Server>> servers_;
  std::vector<ServedInstrument> instruments_;
  std::uint16_t usbip_port_ = 0;
};

}  // namespace fogbench::simulator
