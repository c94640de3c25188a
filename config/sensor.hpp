#pragma once
// Auxiliary sensors as data: instruments that only measure (a barometer, a voltmeter), described by
// a device file as all others are. Each quantity of one is a channel of the record under the name
// that the file gives it; no procedure depends on it unless it says so. One description drives the
// driver and the simulated instrument.

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "config/device.hpp"
#include "config/units.hpp"

namespace fogbench::config {

/// How a quantity goes in the simulated room: mean + swing sin(2 pi t / period), and the sensor's
/// noise on top. In the channel's unit.
struct SimulatedQuantity {
  double mean = 0.0;
  double swing = 0.0;
  Seconds period{7200.0};
  double noise = 0.0;
};

/// One quantity that a sensor measures: value = number * scale + offset, in the unit that its name
/// ends in. A value outside [minimum, maximum] is no reading.
struct SensorChannel {
  std::string name;     ///< "pressure_hpa"
  std::string meaning;  ///< "air pressure in the room"
  double scale = 1.0;
  double offset = 0.0;
  std::optional<double> minimum, maximum;
  SimulatedQuantity simulated;
};

struct RegisterChannel : SensorChannel {
  std::uint16_t address = 0;
  NumberType type = NumberType::kInt16;
  WordOrder word_order = WordOrder::kHighFirst;
  RegisterSpec place() const;
};
struct QueryChannel : SensorChannel {
  std::string query;  ///< "MEAS:VOLT?"
};
struct FieldChannel : SensorChannel {
  std::uint16_t offset_bytes = 0;
  NumberType type = NumberType::kInt32;
  FieldSpec place() const;
};
struct LineChannel : SensorChannel {
  std::uint16_t position = 0;  ///< among the numbers of the line, counted from 0
};

/// Holding registers on Modbus RTU or TCP.
struct ModbusSensor {
  std::string name;
  std::uint8_t unit_id = 1;
  std::vector<RegisterChannel> channels;
};

/// Questions to a SCPI instrument on USBTMC or serial.
struct ScpiSensor {
  std::string name;
  std::string identity;                 ///< what *IDN? must contain
  std::vector<std::string> initialise;  ///< sent on opening, each followed by the error query
  std::string error_query = "SYST:ERR?";
  std::vector<QueryChannel> channels;
  /// The dialogue that all SCPI instruments have in common; it sets nothing.
  ScpiDevice dialogue() const;
};

/// Numbers in a USB HID device's input report.
struct HidSensor {
  std::string name;
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  std::uint8_t report_id = 0;
  std::uint16_t report_bytes = 0;
  ByteOrder byte_order = ByteOrder::kLittleEndian;
  Seconds report_period{1.0};
  std::vector<FieldChannel> channels;
  /// The report's layout, its numbers named as the channels are.
  HidDevice layout() const;
};

/// Lines of text on a serial line, sent unasked: numbers between separators.
struct LineSensor {
  std::string name;
  std::uint32_t baud = 9600;
  std::string separator = ",";
  Seconds period{1.0};   ///< from one line to the next
  Seconds max_age{5.0};  ///< an older line is stale
  std::vector<LineChannel> channels;
};

using SensorDevice = std::variant<ModbusSensor, ScpiSensor, HidSensor, LineSensor>;

/// In the order of the file.
std::vector<SensorChannel> channels_of(const SensorDevice& device);
const std::string& name_of(const SensorDevice& device);

}  // namespace fogbench::config
