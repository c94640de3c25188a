#pragma once
// The JSON shape of auxiliary sensors (sensor.hpp): keys, sentences, bounds.

#include "config/codec.hpp"
#include "config/describe_device.hpp"
#include "config/sensor.hpp"

namespace fogbench::config {

template <class Visitor>
void describe(Visitor& v, SimulatedQuantity& q) {
  v.required("mean", q.mean, "What it is on average.");
  v.optional("swing", q.swing, "Amplitude of its slow change.", at_least(0));
  v.optional("period_s", q.period, "Period of its slow change.", above(0));
  v.optional("noise", q.noise, "Standard deviation of a reading.", at_least(0));
}

template <class Visitor>
void describe_channel(Visitor& v, SensorChannel& c) {
  v.required("name", c.name,
             "The channel's name in records and exports; it ends in the unit: pressure_hpa.");
  v.optional("meaning", c.meaning, "What is measured, in a few words.");
  v.optional("scale", c.scale, "value = number * scale + offset, in the unit of the name.");
  v.optional("offset", c.offset, "Value at number 0.");
  v.optional("minimum", c.minimum, "A lower value is no reading.");
  v.optional("maximum", c.maximum, "A higher value is no reading.");
  v.optional("simulated", c.simulated, "How the quantity goes on the simulated bench.");
}

template <class Visitor>
void describe(Visitor& v, RegisterChannel& c) {
  describe_channel(v, c);
  v.required("address", c.address, "Address of its holding register, counted from 0.");
  v.optional("type", c.type, "How the number lies in one or two registers.");
  v.optional("word_order", c.word_order, "Which word of a 32-bit number comes first.");
}
template <class Visitor>
void describe(Visitor& v, QueryChannel& c) {
  describe_channel(v, c);
  v.required("query", c.query, "The question that is answered with the number.");
}
template <class Visitor>
void describe(Visitor& v, FieldChannel& c) {
  describe_channel(v, c);
  v.required("offset_bytes", c.offset_bytes, "Position of its first byte, counted from 0.");
  v.optional("type", c.type, "How the number lies in its bytes.");
}
template <class Visitor>
void describe(Visitor& v, LineChannel& c) {
  describe_channel(v, c);
  v.required("position", c.position, "Which number of the line it is, counted from 0.");
}

template <class Visitor>
void describe(Visitor& v, ModbusSensor& s) {
  v.tag("kind", "modbus_sensor");
  v.required("name", s.name, "Make and model.");
  v.optional("unit_id", s.unit_id,
             "Modbus address: 1 ... 247 on a serial line; over TCP also 0 or 255.",
             between(0, 255));
  v.required("channels", s.channels, "What it measures, a holding register each.", not_empty());
}
template <class Visitor>
void describe(Visitor& v, ScpiSensor& s) {
  v.tag("kind", "scpi_sensor");
  v.required("name", s.name, "Make and model.");
  v.required("identity", s.identity, "What the answer to *IDN? must contain.");
  v.optional("initialise", s.initialise,
             "Commands sent on opening, each followed by the error query.");
  v.optional("error_query", s.error_query, "Query for the oldest entry of the error queue.");
  v.required("channels", s.channels, "What it measures, a question each.", not_empty());
}
template <class Visitor>
void describe(Visitor& v, HidSensor& s) {
  v.tag("kind", "hid_sensor");
  v.required("name", s.name, "Make and model.");
  v.required("vendor_id", s.vendor_id, "USB vendor.");
  v.required("product_id", s.product_id, "USB product.");
  v.required("report_id", s.report_id, "First byte of the input report.");
  v.required("report_bytes", s.report_bytes, "Length of the report with its id.", at_least(2));
  v.optional("byte_order", s.byte_order, "Of the numbers in the report.");
  v.optional("report_period_s", s.report_period, "Time from one report to the next.",
             between(0.0001, 60));
  v.required("channels", s.channels, "What it measures, a number of the report each.", not_empty());
}
template <class Visitor>
void describe(Visitor& v, LineSensor& s) {
  v.tag("kind", "line_sensor");
  v.required("name", s.name, "Make and model.");
  v.optional("baud", s.baud, "Bits a second on the line.", at_least(300));
  v.optional("separator", s.separator, "What stands between two numbers of a line.");
  v.optional("period_s", s.period, "Time from one line to the next.", between(0.01, 60));
  v.optional("max_age_s", s.max_age, "An older line is stale.", above(0));
  v.required("channels", s.channels, "What it measures, a number of the line each.", not_empty());
}

bool check(const Place& at, const ModbusSensor& sensor);
bool check(const Place& at, const ScpiSensor& sensor);
bool check(const Place& at, const HidSensor& sensor);
bool check(const Place& at, const LineSensor& sensor);

}  // namespace fogbench::config
