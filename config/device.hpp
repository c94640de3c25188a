#pragma once
// Instruments as data: register maps, SCPI dialogues, HID report layouts and serial frame layouts
// (config/devices/*.json). One description drives both the driver and the simulated instrument.
//
// A file states its numbers in the instrument's units. Reading it takes scales, offsets and limits
// to the house's (house_units.hpp), so that below `unit` is one of those: deg/h, degC, uT, A, W,
// deg.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/units.hpp"

namespace fogbench::config {

/// How a number lies in registers, in a report or in a frame.
enum class NumberType { kUint8, kInt8, kUint16, kInt16, kUint32, kInt32, kFloat32 };
enum class WordOrder { kHighFirst, kLowFirst };  ///< of the 16-bit words of a 32-bit Modbus value
enum class ByteOrder { kBigEndian, kLittleEndian };
enum class Access { kRead, kWrite, kReadWrite };

/// One named quantity of a Modbus instrument: value = raw * scale + offset, in `unit`.
/// A value outside [minimum, maximum] is refused before it reaches the wire, and is an error when
/// it is read.
struct RegisterSpec {
  std::string name;
  std::uint16_t address = 0;
  NumberType type = NumberType::kInt16;
  double scale = 1.0;
  double offset = 0.0;
  WordOrder word_order = WordOrder::kHighFirst;
  Access access = Access::kRead;
  std::string unit;  ///< empty for a count
  std::optional<double> minimum;
  std::optional<double> maximum;
};

/// A thermostat controller on Modbus RTU or TCP, holding registers only.
/// The thermostat driver asks for these names: temperature_working_1, temperature_working_2,
/// temperature_control, temperature_ambient, target, mode, boost_power, normal_power,
/// and optionally working_target and status.
struct ModbusDevice {
  std::string name;
  std::uint8_t unit_id = 1;       ///< 1 ... 247 on a serial line; over TCP any
  bool even_counts_only = false;  ///< Omron's 4-byte space takes even register counts only
  std::vector<RegisterSpec> registers;
  /// What to write to (and read back from) the register `mode` for each heating mode; keys off,
  /// boost, normal.
  std::map<std::string, double> modes;
  Celsius target_minimum{0.0};
  Celsius target_maximum{0.0};
  Seconds max_age{2.0};  ///< an older reading is stale
  /// First-order lag of the sensors on the carrier, which the averages are freed of.
  Seconds sensor_lag{0.0};
  /// All temperatures unchanged to the last bit for this long are stale; nothing where the
  /// resolution is coarser than the noise.
  std::optional<Seconds> stuck_after;
};

/// A SCPI instrument on USBTMC (a coil supply) or serial (a turntable). `{value}` stands for the
/// number.
struct ScpiDevice {
  std::string name;
  std::string identity;                 ///< what *IDN? must contain
  std::vector<std::string> initialise;  ///< sent on opening, each followed by the error query
  std::string set;                      ///< "CURR {value}"
  std::string set_query;                ///< "CURR?"
  std::string measure_query;            ///< "MEAS:CURR?"
  std::string output_on;                ///< "OUTP ON"; empty when it has none
  std::string output_off;               ///< "OUTP OFF"
  std::string error_query = "SYST:ERR?";
  std::vector<int> busy_errors;  ///< numbers in the error queue that only ask for time
  std::string unit;              ///< of the value, "A" or "deg"
  double scale = 1.0;            ///< value of one on the wire: 0.001 for a supply spoken to in mA
  double minimum = 0.0;
  double maximum = 0.0;
  double resolution = 0.0;           ///< smallest step of the output
  double read_back_tolerance = 0.0;  ///< |measured - set| above it is an error
  Seconds settle{0.32};              ///< after a set, before the measurement is valid
};

/// One number inside a HID report or a serial frame: value = raw * scale + offset.
struct FieldSpec {
  std::string name;
  std::uint16_t offset_bytes = 0;
  NumberType type = NumberType::kInt32;
  double scale = 1.0;
  double offset = 0.0;
  std::string unit;  ///< empty for a count
};

/// A three-axis magnetometer that sends input reports. Fields: field_x, field_y, field_z (uT),
/// and optionally sequence and status. The calibrated field is
/// matrix * (reported - offset), the certificate's correction.
struct HidDevice {
  std::string name;
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  std::uint8_t report_id = 0;
  std::uint16_t report_bytes = 0;  ///< with the report id
  ByteOrder byte_order = ByteOrder::kLittleEndian;
  std::vector<FieldSpec> fields;
  Microtesla range{0.0};  ///< a field beyond it reads saturated and is an error
  std::array<double, 3> calibration_offset_ut{0.0, 0.0, 0.0};
  std::array<std::array<double, 3>, 3> calibration_matrix{
      {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
  Seconds report_period{0.1};
  Seconds max_age{1.0};
  std::optional<Seconds> stuck_after;  ///< as a ModbusDevice's, of the three axes
};

/// A cyclic redundancy check in the Rocksoft model's parameters.
struct CrcSpec {
  std::uint8_t width_bits = 32;  ///< 8, 16 or 32
  std::uint32_t polynomial = 0;
  std::uint32_t initial = 0;
  std::uint32_t final_xor = 0;
  bool reflected = false;
  std::uint16_t first_byte = 0;  ///< covers [first_byte, first_byte + count_bytes)
  std::uint16_t count_bytes = 0;
  std::uint16_t offset_bytes = 0;  ///< where the check value lies
  ByteOrder byte_order = ByteOrder::kBigEndian;
};

/// A gyro that streams fixed-length frames.
struct FrameDevice {
  std::string name;
  std::vector<std::uint8_t> header;
  std::uint16_t frame_bytes = 0;
  ByteOrder byte_order = ByteOrder::kBigEndian;
  FieldSpec rate;
  std::optional<FieldSpec> temperature;
  std::vector<FieldSpec> others;  ///< the rest of the payload, named for the documents
  std::optional<std::uint16_t> status_offset_bytes;  ///< none: every frame is valid
  std::uint8_t status_valid_mask = 0;                ///< all these bits set: the reading is valid
  std::uint16_t sequence_offset_bytes = 0;
  NumberType sequence_type = NumberType::kUint8;
  std::uint64_t sequence_modulus = 128;  ///< counts 0 ... modulus - 1
  CrcSpec crc;
  double frame_rate_hz = 1000.0;
  std::uint32_t baud = 921600;
  /// As a ModbusDevice's, of the rate: frames that repeat it beyond are not valid.
  std::optional<Seconds> stuck_after;
};

}  // namespace fogbench::config
