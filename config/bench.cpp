#include "config/bench.hpp"

#include <algorithm>
#include <chrono>

#include "config/connection.hpp"
#include "config/describe_bench.hpp"
#include "config/json_file.hpp"
#include "config/paths.hpp"
#include "config/roles.hpp"

namespace fogbench::config {
namespace {

/// Every kind of instrument has its own ways to be reached; all can be simulated.
bool check_scheme(const Place& at, const InstrumentConfig& i,
                  std::initializer_list<std::string_view> schemes, std::string_view expected) {
  return i.connection == "simulated" ||
         std::any_of(schemes.begin(), schemes.end(),
                     [&](std::string_view scheme) { return i.connection.starts_with(scheme); }) ||
         (at / "connection").wrong(expected);
}

/// Nobody is taken for another: neither an instrument nor a channel.
bool check_auxiliary(const Place& at, const BenchConfig& b) {
  std::vector<std::string> names;
  for_each_role([&](const char* role, const auto&) { names.emplace_back(role); }, b);
  std::vector<std::string> channels;
  const auto is_new = [](std::vector<std::string>& known, const std::string& name) {
    if (std::find(known.begin(), known.end(), name) != known.end()) return false;
    known.push_back(name);
    return true;
  };
  for (std::size_t i = 0; i < b.auxiliary.size(); ++i) {
    if (!is_new(names, b.auxiliary[i].name)) {
      return (at / i / "name").wrong("a name that no other instrument has");
    }
    for (const SensorChannel& channel : channels_of(b.auxiliary[i].device)) {
      if (!is_new(channels, channel.name)) {
        return (at / i / "device")
            .fail(fmt::format("has a channel {}, as a sensor before it has", channel.name));
      }
    }
  }
  return true;
}

}  // namespace

std::optional<std::chrono::sys_days> date_of(const std::string& text) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return std::nullopt;
  for (const std::size_t i : {0U, 1U, 2U, 3U, 5U, 6U, 8U, 9U}) {
    if (text[i] < '0' || text[i] > '9') return std::nullopt;
  }
  const std::chrono::year_month_day date{
      std::chrono::year{std::stoi(text.substr(0, 4))},
      std::chrono::month{static_cast<unsigned>(std::stoi(text.substr(5, 2)))},
      std::chrono::day{static_cast<unsigned>(std::stoi(text.substr(8, 2)))}};
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days{date};
}

std::vector<SensorChannel> auxiliary_channels(const BenchConfig& bench) {
  std::vector<SensorChannel> all;
  for (const AuxiliaryConfig& sensor : bench.auxiliary) {
    const auto its = channels_of(sensor.device);
    all.insert(all.end(), its.begin(), its.end());
  }
  return all;
}

bool Codec<DeviceReference<SensorDevice>>::read(const Place& at, DeviceReference<SensorDevice>& out,
                                                const Rule& /*rule*/) {
  std::optional<DeviceFile> file = read_named_device(at);
  if (!file) return false;
  const auto take = [&]<class Device>(Device& device) {
    if constexpr (std::is_constructible_v<SensorDevice, Device>) {
      out.device = std::move(device);
      return true;
    } else {
      return at.fail(
          "names no sensor; expected a device file of the kind modbus_sensor, "
          "scpi_sensor, hid_sensor or line_sensor");
    }
  };
  return std::visit(take, *file);
}

std::optional<DeviceFile> read_named_device(const Place& at) {
  std::string name;
  if (!read_text(at, name)) return std::nullopt;
  const auto file = device_file(at.file(), name);
  if (!file) {
    at.fail(file.error().message);
    return std::nullopt;
  }
  auto device = load_device(*file);
  if (!device) {
    at.fail(device.error());
    return std::nullopt;
  }
  return std::move(*device);
}

Result<std::filesystem::path> device_file(const std::filesystem::path& bench,
                                          const std::string& device) {
  namespace fs = std::filesystem;
  const fs::path folder = bench.parent_path();
  const bool plain = device.find('/') == std::string::npos;
  const fs::path relative = (folder / device).lexically_normal();
  const fs::path beside = (folder / "../devices" / (device + ".json")).lexically_normal();
  std::error_code error;
  if (fs::is_regular_file(relative, error)) return relative;
  if (plain && fs::is_regular_file(beside, error)) return beside;
  const auto ready = find_ready("devices", plain ? device : fs::path(device).stem().string());
  if (plain && ready) return ready;
  const std::string is = fs::exists(relative, error) ? "not a file" : "no such file";
  if (ready) {
    return bad_input(fmt::format(
        "\"{}\", seen from this file, is {}: {}; expected a path from "
        "there, or the ready device's name, \"{}\"",
        one_line(device), one_line(relative.string(), 200), is, ready->stem().string()));
  }
  return bad_input(
      fmt::format("\"{}\", seen from this file, is {}: {}; expected a path from "
                  "there, or a ready device ({})",
                  one_line(device), one_line(relative.string(), 200), is, ready_names("devices")));
}

bool check(const Place& at, const InstrumentConfig& i) {
  const auto connection = parse_connection(i.connection);
  if (!connection) return (at / "connection").fail(connection.error().message);
  for (const auto& [key, date] : {std::pair{"calibrated_on", &i.calibrated_on},
                                  std::pair{"calibration_due", &i.calibration_due}}) {
    if (!date->empty() && !date_of(*date)) return (at / key).wrong("a date, YYYY-MM-DD");
  }
  return true;
}

bool check_unit(const Place& at, const InstrumentConfig& i, std::uint8_t unit_id) {
  return !i.connection.starts_with("rtu:") || is_unit_of_serial_line(unit_id) ||
         (at / "device")
             .fail(fmt::format("unit_id is {}; expected 1 to 247 on a serial line", unit_id));
}

bool check(const Place& at, const ThermostatConfig& t) {
  return check(at, static_cast<const InstrumentConfig&>(t)) &&
         check_scheme(at, t, {"tcp:", "rtu:"}, "a thermostat on tcp: or rtu:") &&
         check_unit(at, t, t.device.unit_id);
}

/// A HID instrument is found by the numbers that its description states.
template <class Device>
bool check_usb_ids(const Place& at, const InstrumentConfig& i, const Device& device) {
  const auto connection = parse_connection(i.connection);
  const auto* const hid = connection ? std::get_if<HidConnection>(&*connection) : nullptr;
  return hid == nullptr || (hid->vendor == device.vendor_id && hid->product == device.product_id) ||
         (at / "connection")
             .wrong(fmt::format("hid:0x{:04x}:0x{:04x}: as {} describes itself", device.vendor_id,
                                device.product_id, device.name));
}

bool check(const Place& at, const MagnetometerConfig& m) {
  if (m.fitted != (at / "device").present()) {
    return (at / "device")
        .wrong(m.fitted ? "a device file; \"fitted\": false says that there is no magnetometer"
                        : "none: no magnetometer is fitted");
  }
  if (!m.fitted) return check(at, static_cast<const InstrumentConfig&>(m));
  if ((at / "ambient_ut").present()) {
    return (at / "ambient_ut").wrong("none: the magnetometer measures the ambient field");
  }
  return check(at, static_cast<const InstrumentConfig&>(m)) &&
         check_scheme(at, m, {"hid:"}, "a magnetometer on hid:") && check_usb_ids(at, m, m.device);
}

bool check(const Place& at, const CoilConfig& c) {
  if (!check(at, static_cast<const InstrumentConfig&>(c)) ||
      !check_scheme(at, c, {"usb:", "tty:"}, "a coil supply on usb: or tty:")) {
    return false;
  }
  if (c.device.unit != "A") {
    return (at / "device")
        .fail(fmt::format("sets {}; expected a supply that sets A", c.device.unit));
  }
  const double most = std::min(c.device.maximum, -c.device.minimum);
  if (c.current_limit.value > most) {
    return (at / "current_limit_a")
        .wrong(fmt::format("at most {} A, what {} gives in both "
                           "directions",
                           most, c.device.name));
  }
  return true;
}

bool check(const Place& at, const TurntableConfig& t) {
  if (!check(at, static_cast<const InstrumentConfig&>(t)) ||
      !check_scheme(at, t, {"usb:", "tty:"}, "a turntable on usb: or tty:")) {
    return false;
  }
  if (t.motorised != t.device.has_value()) {
    return (at / "device")
        .wrong(t.motorised ? "a device file: the turntable is motorised"
                           : "none: the turntable is not motorised");
  }
  if (t.device && t.device->unit != "deg") {
    return (at / "device")
        .fail(fmt::format("sets {}; expected a turntable that sets deg", t.device->unit));
  }
  return true;
}

bool check(const Place& at, const GyroConfig& g) {
  if (!check(at, static_cast<const InstrumentConfig&>(g)) ||
      !check_scheme(at, g, {"tty:"}, "a gyro on tty:")) {
    return false;
  }
  if (!check_frame_rate(at, g.device)) return false;
  return g.max_gap.count() * g.device.frame_rate_hz >= 1.0 ||
         (at / "max_gap_s")
             .wrong(fmt::format("at least one frame, {} s", 1.0 / g.device.frame_rate_hz));
}

bool check(const Place& at, const AuxiliaryConfig& a) {
  if (!is_identifier(a.name)) return (at / "name").wrong(kIdentifier);
  if (!check(at, static_cast<const InstrumentConfig&>(a))) return false;
  const auto with = [&](std::initializer_list<std::string_view> schemes,
                        std::string_view expected) {
    return check_scheme(at, a, schemes, expected);
  };
  if (const auto* const modbus = std::get_if<ModbusSensor>(&a.device)) {
    return with({"tcp:", "rtu:"}, "a Modbus sensor on tcp: or rtu:") &&
           check_unit(at, a, modbus->unit_id);
  }
  if (std::holds_alternative<ScpiSensor>(a.device)) {
    return with({"usb:", "tty:"}, "a SCPI sensor on usb: or tty:");
  }
  if (const auto* const hid = std::get_if<HidSensor>(&a.device)) {
    return with({"hid:"}, "a HID sensor on hid:") && check_usb_ids(at, a, *hid);
  }
  return with({"tty:"}, "a sensor on tty:");
}

bool check(const Place& at, const MagneticPlant& m) {
  return is_invertible(m.sensor_matrix) ||
         (at / "sensor_matrix").fail("cannot be inverted; expected a matrix near the unit matrix");
}

bool check(const Place& at, const BenchConfig& b) {
  const Place limits = at / "limits";
  if (b.limits.temperature_minimum >= b.limits.temperature_maximum) {
    return (limits / "temperature_minimum_c")
        .wrong(
            fmt::format("less than temperature_maximum_c {}", b.limits.temperature_maximum.value));
  }
  if (b.limits.temperature_maximum > b.thermostat.device.target_maximum) {
    return (limits / "temperature_maximum_c")
        .fail(fmt::format("{} degC; expected at most the thermostat's target_maximum_c {}",
                          b.limits.temperature_maximum.value,
                          b.thermostat.device.target_maximum.value));
  }
  if (!check_auxiliary(at / "auxiliary", b)) return false;
  const Place interlocks = at / "interlocks";
  return !interlocks.present() || check_interlocks(interlocks, b);
}

ThermalReach reach_of(const ThermalPlant& plant) {
  const double j_per_k = plant.heater_j_per_k + plant.carrier_j_per_k + plant.coil_j_per_k;
  const auto rate = [j_per_k](Watt power) {
    return CelsiusPerHour{power.value / j_per_k * kSecondsPerHour};
  };
  return {.boost = rate(plant.boost_maximum),
          .normal = rate(plant.normal_maximum),
          .cooling = rate(plant.cooling_maximum),
          .time_constant = Seconds{j_per_k / plant.carrier_ambient_w_per_k}};
}

Result<BenchConfig> load_bench(const std::filesystem::path& file) {
  auto bench = read_config<BenchConfig>(file);
  if (!bench) return bench;
  if (bench->interlocks.empty()) bench->interlocks = default_interlocks(*bench);
  if (!bench->thermal && bench->thermostat.connection == "simulated") {
    bench->thermal = reach_of(bench->simulation.thermal);
  }
  return bench;
}

}  // namespace fogbench::config
