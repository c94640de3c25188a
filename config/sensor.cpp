#include "config/sensor.hpp"

#include <algorithm>

#include "config/channels.hpp"
#include "config/describe_sensor.hpp"

namespace fogbench::config {
namespace {

/// Names that the record and nobody else has, and numbers that make sense.
template <class Channel>
bool check_channels(const Place& at, const std::vector<Channel>& channels) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const SensorChannel& c = channels[i];
    const Place place = at / i;
    if (!is_identifier(c.name)) return (place / "name").wrong(kIdentifier);
    const bool taken =
        find_channel(c.name) != nullptr ||
        std::find(kOtherColumns.begin(), kOtherColumns.end(), c.name) != kOtherColumns.end();
    if (taken) return (place / "name").wrong("a name that no column of the record has already");
    for (std::size_t j = 0; j < i; ++j) {
      if (channels[j].name == c.name) {
        return (place / "name").wrong("a name that does not stand twice");
      }
    }
    if (c.scale == 0.0) return (place / "scale").wrong("a number other than 0");
    if (c.minimum && c.maximum && *c.minimum > *c.maximum) {
      return (place / "minimum").wrong(fmt::format("at most the maximum {}", *c.maximum));
    }
  }
  return true;
}

std::size_t bytes_of(NumberType type) {
  if (type == NumberType::kUint8 || type == NumberType::kInt8) return 1;
  return type == NumberType::kUint16 || type == NumberType::kInt16 ? 2 : 4;
}

}  // namespace

RegisterSpec RegisterChannel::place() const {
  return {.name = name,
          .address = address,
          .type = type,
          .scale = scale,
          .offset = offset,
          .word_order = word_order};
}

FieldSpec FieldChannel::place() const {
  return {
      .name = name, .offset_bytes = offset_bytes, .type = type, .scale = scale, .offset = offset};
}

ScpiDevice ScpiSensor::dialogue() const {
  ScpiDevice device;
  device.name = name;
  device.identity = identity;
  device.initialise = initialise;
  device.error_query = error_query;
  return device;
}

HidDevice HidSensor::layout() const {
  HidDevice device;
  device.name = name;
  device.vendor_id = vendor_id;
  device.product_id = product_id;
  device.report_id = report_id;
  device.report_bytes = report_bytes;
  device.byte_order = byte_order;
  device.report_period = report_period;
  for (const FieldChannel& channel : channels) device.fields.push_back(channel.place());
  return device;
}

std::vector<SensorChannel> channels_of(const SensorDevice& device) {
  return std::visit(
      [](const auto& sensor) {
        return std::vector<SensorChannel>(sensor.channels.begin(), sensor.channels.end());
      },
      device);
}

const std::string& name_of(const SensorDevice& device) {
  return std::visit([](const auto& sensor) -> const std::string& { return sensor.name; }, device);
}

bool check(const Place& at, const ModbusSensor& s) {
  const Place channels = at / "channels";
  for (std::size_t i = 0; i < s.channels.size(); ++i) {
    if (bytes_of(s.channels[i].type) == 1) {
      return (channels / i / "type").wrong("a type of 16 or 32 bits");
    }
  }
  return check_channels(channels, s.channels);
}

bool check(const Place& at, const ScpiSensor& s) {
  const Place channels = at / "channels";
  for (std::size_t i = 0; i < s.channels.size(); ++i) {
    if (!s.channels[i].query.ends_with('?')) {
      return (channels / i / "query").wrong("a question, which ends in ?");
    }
  }
  return check_channels(channels, s.channels);
}

bool check(const Place& at, const HidSensor& s) {
  const Place channels = at / "channels";
  const std::size_t first = s.report_id != 0 ? 1 : 0;
  for (std::size_t i = 0; i < s.channels.size(); ++i) {
    const FieldChannel& c = s.channels[i];
    const std::size_t end = c.offset_bytes + bytes_of(c.type);
    if (c.offset_bytes < first || end > s.report_bytes) {
      return (channels / i / "offset_bytes")
          .wrong(fmt::format("the number to lie inside the report of {} bytes, behind its id",
                             s.report_bytes));
    }
  }
  return check_channels(channels, s.channels);
}

bool check(const Place& at, const LineSensor& s) {
  return check_channels(at / "channels", s.channels);
}

}  // namespace fogbench::config
