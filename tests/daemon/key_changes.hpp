#pragma once
// Other values for a key of a configuration file: near ones first, then such as would be noticed.

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace fogbench::daemon {

/// Keys that a bench may have besides those of the ready files, and a neighbourhood with lifts.
inline constexpr auto kFurtherKeys = R"({
  "limits": {"compensation_maximum_ut": 55, "absence_maximum_s": 30},
  "thermal": {"boost_c_per_h": 52, "normal_c_per_h": 39, "cooling_c_per_h": 2, "time_constant_s": 3800},
  "estimates": {"room_c": 21, "heating_c_per_h": 45, "cooling_c_per_h": 10, "settling_s": 1400,
                "compensation_s": 15, "operator_answer_s": 60},
  "simulation": {"magnetic": {"ambient_steps_per_h": 600}}})";

/// Keys that tell people something; nothing is done with them but to record them.
inline bool is_for_people(std::string_view pointer) {
  for (const std::string_view key : {"/name", "/description", "/meaning", "/serial_number",
                                     "/calibrated_on", "/calibration_due"}) {
    if (pointer.ends_with(key)) return true;
  }
  return false;
}

inline std::vector<nlohmann::json> changes_of(const std::string& pointer,
                                              const nlohmann::json& value) {
  using nlohmann::json;
  if (value.is_boolean()) return {!value.get<bool>()};
  if (value.is_number_integer()) {
    const auto number = value.get<std::int64_t>();
    return {number + 1, number - 1,  2 * number,  number / 2, number / 6, 10 * number,
            1,          number + 30, number - 30, 0,          -number,    1e-6};
  }
  if (value.is_number()) {
    const double number = value.get<double>();
    return {1.01 * number, 0.99 * number, 1.5 * number,  0.5 * number,
            0.2 * number,  0.01 * number, 1000 * number, -number};
  }
  const auto text = value.get<std::string>();
  if (text.starts_with("0x")) {
    const auto number = std::stoll(text.substr(2), nullptr, 16);
    return {number + 1, number - 1, number ^ 0x10};
  }
  const auto ends = [&](const char* key) { return pointer.ends_with(key); };
  if (ends("connection")) {
    return {"tcp:127.0.0.1:1", "tty:/dev/none", "usb:0x0001:0x0002:X", "hid:0x1209:0x0001:X"};
  }
  if (ends("device")) {
    return {"thermostat-omron", "gyro-crc8", "turntable-scpi", "coil-kepco", "magnetometer-hid"};
  }
  if (ends("calibrated_on") || ends("calibration_due")) return {"2025-01-15"};
  if (ends("unit"))
    return {"banana", "mdeg/s", "rad/s", "mdegC", "K",    "degF", "mT",
            "nT",     "kW",     "mW",    "mA",    "mrad", "mg"};
  if (ends("type")) return {"float32", "int32", "uint32", "uint16", "int16", "uint8", "int8"};
  if (ends("order")) return {"big_endian", "little_endian", "high_first", "low_first"};
  if (ends("access")) return {"read", "write", "read_write"};
  if (ends("action")) return {"warn", "pause", "abort"};
  if (ends("header")) return {"FE 81 FF 56", "A5 5B"};
  return {text + "x"};
}

}  // namespace fogbench::daemon
