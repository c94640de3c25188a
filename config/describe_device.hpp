#pragma once
// The JSON shape of instrument descriptions (device.hpp): keys, sentences, bounds. The comment on
// each struct there says what it is for.

#include "config/codec.hpp"
#include "config/device.hpp"

namespace fogbench::config {

constexpr std::array<EnumName<NumberType>, 7> enum_names(NumberType /*type*/) {
  return {{{"uint8", NumberType::kUint8},
           {"int8", NumberType::kInt8},
           {"uint16", NumberType::kUint16},
           {"int16", NumberType::kInt16},
           {"uint32", NumberType::kUint32},
           {"int32", NumberType::kInt32},
           {"float32", NumberType::kFloat32}}};
}
constexpr std::array<EnumName<WordOrder>, 2> enum_names(WordOrder /*type*/) {
  return {{{"high_first", WordOrder::kHighFirst}, {"low_first", WordOrder::kLowFirst}}};
}
constexpr std::array<EnumName<ByteOrder>, 2> enum_names(ByteOrder /*type*/) {
  return {{{"big_endian", ByteOrder::kBigEndian}, {"little_endian", ByteOrder::kLittleEndian}}};
}
constexpr std::array<EnumName<Access>, 3> enum_names(Access /*type*/) {
  return {{{"read", Access::kRead}, {"write", Access::kWrite}, {"read_write", Access::kReadWrite}}};
}

/// Bytes as people write them: "FE 81 FF 55".
template <>
struct Codec<std::vector<std::uint8_t>> {
  static bool read(const Place& at, std::vector<std::uint8_t>& out, const Rule& rule);
  static ordered_json schema(const Rule& rule);
  static ordered_json write(const std::vector<std::uint8_t>& bytes);
};

template <class Visitor>
void describe(Visitor& v, RegisterSpec& r) {
  v.required("name", r.name, "Quantity that this register holds.");
  v.required("address", r.address, "Address on the wire, counted from 0.");
  v.optional("type", r.type, "How the number lies in one or two registers.");
  v.optional("scale", r.scale, "Value of one count: value = raw * scale + offset.");
  v.optional("offset", r.offset, "Value at raw 0.");
  v.optional("word_order", r.word_order, "Which word of a 32-bit number comes first.");
  v.optional("access", r.access, "What the instrument allows.");
  v.optional("unit", r.unit,
             "Unit of the value and its limits; temperatures are in degC and powers in W without "
             "it. A count has none.");
  v.optional("minimum", r.minimum,
             "A lower value is refused before it reaches the wire, and is an error when it is "
             "read. In the unit of the value.");
  v.optional("maximum", r.maximum, "A higher value likewise.");
}

template <class Visitor>
void describe(Visitor& v, ModbusDevice& d) {
  v.tag("kind", "modbus");
  v.required("name", d.name, "Make and model.");
  v.optional(
      "unit_id", d.unit_id,
      "Modbus address of the instrument: 1 ... 247 on a serial line. Over TCP also 0 or 255, "
      "where an instrument answers to nothing else.",
      between(0, 255));
  v.optional("even_counts_only", d.even_counts_only,
             "The instrument takes even register counts only.");
  v.required("registers", d.registers,
             "Holding registers: temperature_working_1, temperature_working_2, "
             "temperature_control, temperature_ambient, target, mode, boost_power, normal_power, "
             "and where the instrument has them working_target and status.",
             not_empty());
  v.required("modes", d.modes,
             "What the register mode holds in each heating mode: off, boost, normal.");
  v.required("target_minimum_c", d.target_minimum, "Lowest set point that the instrument takes.");
  v.required("target_maximum_c", d.target_maximum, "Highest set point that the instrument takes.");
  v.optional("max_age_s", d.max_age, "An older reading is stale.", above(0));
  v.optional("sensor_lag_s", d.sensor_lag,
             "First-order lag of its sensors on the carrier; averages are freed of it.",
             between(0, 120));
  v.optional("stuck_after_s", d.stuck_after,
             "All temperatures unchanged to the last bit for this long are stale. Leave it out "
             "where the resolution is coarser than the noise.",
             above(0));
}

template <class Visitor>
void describe(Visitor& v, ScpiDevice& d) {
  v.tag("kind", "scpi");
  v.required("name", d.name, "Make and model.");
  v.required("identity", d.identity, "What the answer to *IDN? must contain.");
  v.optional("initialise", d.initialise,
             "Commands sent on opening, each followed by the error query.");
  v.required("set", d.set, "Command that sets the value; {value} stands for the number.");
  v.required("set_query", d.set_query, "Query for the value that was set.");
  v.required("measure_query", d.measure_query, "Query for the measured value.");
  v.optional("output_on", d.output_on, "Command that switches the output on, where it has one.");
  v.optional("output_off", d.output_off, "Command that switches the output off, where it has one.");
  v.optional("error_query", d.error_query, "Query for the oldest entry of the error queue.");
  v.optional(
      "busy_errors", d.busy_errors,
      "Numbers in the error queue that only say that it is busy: the command is sent again.");
  v.required("unit", d.unit,
             "Unit of the value, of its limits, resolution and tolerance: A, mA, deg, rad, ...");
  v.optional("scale", d.scale, "Value of one on the wire: value = number * scale.");
  v.required("minimum", d.minimum, "Lowest value, in its unit.");
  v.required("maximum", d.maximum, "Highest value, in its unit.");
  v.required("resolution", d.resolution, "Smallest step of the output, in its unit.", above(0));
  v.required("read_back_tolerance", d.read_back_tolerance,
             "A measured value further than this from the set one is an error, in its unit.",
             above(0));
  v.optional("settle_s", d.settle, "How long after a set the measurement is not valid yet.",
             at_least(0));
}

template <class Visitor>
void describe(Visitor& v, FieldSpec& f) {
  v.required("name", f.name, "Quantity that this number is.");
  v.required("offset_bytes", f.offset_bytes, "Position of its first byte, counted from 0.");
  v.optional("type", f.type, "How the number lies in its bytes.");
  v.optional("scale", f.scale, "Value of one count: value = raw * scale + offset.");
  v.optional("offset", f.offset, "Value at raw 0.");
  v.optional("unit", f.unit,
             "Unit of the value; a rate is in deg/h, a temperature in degC and a field in uT "
             "without it. A count has none.");
}

/// A certificate's correction: calibrated = matrix * (reported - offset).
struct MagnetometerCalibration {
  std::array<double, 3>& offset_ut;
  std::array<std::array<double, 3>, 3>& matrix;
};
bool is_invertible(const std::array<std::array<double, 3>, 3>& matrix);

template <class Visitor>
void describe(Visitor& v, MagnetometerCalibration& c) {
  v.required("offset_ut", c.offset_ut, "Reading in zero field, x, y, z.");
  v.required("matrix", c.matrix,
             "Rows of the matrix that takes (reported - offset) to the true field; it corrects "
             "scale and orthogonality.");
}

template <>
struct Codec<MagnetometerCalibration> {
  static bool read(const Place& at, MagnetometerCalibration& out, const Rule& rule);
  static ordered_json schema(const Rule& rule);
  static ordered_json write(const MagnetometerCalibration& calibration);
};

template <class Visitor>
void describe(Visitor& v, HidDevice& d) {
  v.tag("kind", "hid");
  v.required("name", d.name, "Make and model.");
  v.required("vendor_id", d.vendor_id, "USB vendor.");
  v.required("product_id", d.product_id, "USB product.");
  v.required("report_id", d.report_id, "First byte of the input report that carries the field.");
  v.required("report_bytes", d.report_bytes, "Length of the report with its id.", at_least(2));
  v.optional("byte_order", d.byte_order, "Of the numbers in the report.");
  v.required("fields", d.fields,
             "Numbers in the report: field_x, field_y, field_z, and where it has them "
             "sequence and status.",
             not_empty());
  v.required("range_ut", d.range, "A field beyond it reads saturated and is an error.", above(0));
  MagnetometerCalibration calibration{d.calibration_offset_ut, d.calibration_matrix};
  v.optional("calibration", calibration,
             "The certificate's correction; a bench's own takes its place.");
  v.optional("report_period_s", d.report_period, "Time from one report to the next.",
             between(0.0001, 60));
  v.optional("max_age_s", d.max_age, "An older reading is stale.", above(0));
  v.optional("stuck_after_s", d.stuck_after,
             "Three axes unchanged to the last bit for this long are stale. Leave it out where the "
             "resolution is coarser than the noise.",
             above(0));
}

template <class Visitor>
void describe(Visitor& v, CrcSpec& c) {
  v.required("width_bits", c.width_bits, "8, 16 or 32.");
  v.required("polynomial", c.polynomial, "Without the leading 1, highest power first.");
  v.optional("initial", c.initial, "Register before the first byte.");
  v.optional("final_xor", c.final_xor, "Applied to the register after the last byte.");
  v.optional("reflected", c.reflected, "Bytes enter lowest bit first, the result is mirrored.");
  v.optional("first_byte", c.first_byte, "First byte that the check covers, counted from 0.");
  v.required("count_bytes", c.count_bytes, "How many bytes it covers.", at_least(1));
  v.required("offset_bytes", c.offset_bytes, "Where the check value lies, counted from 0.");
  v.optional("byte_order", c.byte_order, "Of the check value.");
}

template <class Visitor>
void describe(Visitor& v, FrameDevice& d) {
  v.tag("kind", "frame");
  v.required("name", d.name, "Make and model.");
  v.required("header", d.header, "Bytes that every frame starts with, in hexadecimal.");
  v.required("frame_bytes", d.frame_bytes, "Length of a frame with header and check value.",
             at_least(4));
  v.optional("byte_order", d.byte_order, "Of the numbers in the frame.");
  v.required("rate", d.rate, "The rotation rate.");
  v.optional("temperature", d.temperature, "The gyro's temperature, where frames carry it.");
  v.optional("others", d.others, "The rest of the payload.");
  v.optional(
      "status_offset_bytes", d.status_offset_bytes,
      "Where the status byte lies. Without it every frame whose check value holds is valid.");
  v.optional("status_valid_mask", d.status_valid_mask,
             "Bits of the status that are all set while the reading is valid.");
  v.required("sequence_offset_bytes", d.sequence_offset_bytes,
             "Where the frame's counter, its sequence number, begins.");
  v.optional("sequence_type", d.sequence_type,
             "How the counter lies in its bytes: uint8, uint16 or uint32, in the frame's byte "
             "order.");
  v.required("sequence_modulus", d.sequence_modulus,
             "The sequence counts from 0 to one less than this: 256 where a byte counts through, "
             "65536 where 16 bits do.",
             between(2, 4294967296.0));
  v.required("crc", d.crc, "The check value.");
  v.required("frame_rate_hz", d.frame_rate_hz, "Frames a second.", between(0.1, 100000));
  v.optional("baud", d.baud, "Bits a second on the line, 10 bits a byte.", at_least(300));
  v.optional(
      "stuck_after_s", d.stuck_after,
      "Frames that repeat the rate to the last bit for longer than this are not valid. Leave "
      "it out where the resolution is coarser than the noise.",
      above(0));
}

/// Names that no driver knows and those that it misses, whatever else is wrong.
bool check_names(const Place& at, const ModbusDevice& device);
bool check(const Place& at, const ModbusDevice& device);
bool check(const Place& at, const ScpiDevice& device);
bool check(const Place& at, const HidDevice& device);
bool check(const Place& at, const FrameDevice& device);
/// Whether the line carries that many frames a second.
bool check_frame_rate(const Place& at, const FrameDevice& device);

}  // namespace fogbench::config
