#include "drivers/auxiliary_sensor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <type_traits>
#include <utility>

#include "config/json_file.hpp"
#include "drivers/named_error.hpp"
#include "drivers/number_codec.hpp"
#include "drivers/scpi_dialogue.hpp"

namespace fogbench::drivers {
namespace {

using config::SensorChannel;

/// A line that is longer is no line of numbers, but noise at a wrong rate.
constexpr std::size_t kLongestSensorLine = 4096;

/// What all kinds have in common; `Device` is the description, which says how one channel is read.
template <class Device>
class Sensor : public AuxiliarySensor {
 public:
  Sensor(std::string name, Device device) : device_(std::move(device)), name_(std::move(name)) {
    channels_.assign(device_.channels.begin(), device_.channels.end());
  }

  Result<std::string> identity() override { return device_.name; }
  const std::string& name() const override { return name_; }
  const std::vector<SensorChannel>& channels() const override { return channels_; }

 protected:
  /// The value when it can be one.
  Result<double> within(const SensorChannel& channel, Result<double> value) const {
    if (!value) return named(name_, value.error());
    if ((channel.minimum && *value < *channel.minimum) ||
        (channel.maximum && *value > *channel.maximum)) {
      return Error{ErrorCode::kLimit,
                   fmt::format("{}: {} reads {:g}, which cannot be", name_, channel.name, *value)};
    }
    return value;
  }
  std::vector<Result<double>> all(const Error& error) const {
    return std::vector<Result<double>>(channels_.size(), named(name_, error));
  }

  const Device device_;

 private:
  std::string name_;
  std::vector<SensorChannel> channels_;
};

class ModbusSensor final : public Sensor<config::ModbusSensor> {
 public:
  ModbusSensor(std::string name, const config::ModbusSensor& device,
               std::unique_ptr<ModbusTransport> transport)
      : Sensor(std::move(name), device), transport_(std::move(transport)) {}

  std::vector<Result<double>> read() override {
    std::vector<Result<double>> out;
    for (const config::RegisterChannel& channel : device_.channels) {
      std::vector<std::uint16_t> words(word_count(channel.type));
      const Status came = transport_->read_registers(channel.address, words);
      // Whoever is silent for one register is so for the next: that would only take time.
      if (!came && came.error().code != ErrorCode::kDevice) return all(came.error());
      out.push_back(within(
          channel, came ? read_words(channel.place(), words) : Result<double>(came.error())));
    }
    return out;
  }

 private:
  std::unique_ptr<ModbusTransport> transport_;
};

class ScpiSensor final : public Sensor<config::ScpiSensor> {
 public:
  ScpiSensor(std::string name, const config::ScpiSensor& device, ScpiDialogue dialogue)
      : Sensor(std::move(name), device), dialogue_(std::move(dialogue)) {}

  Result<std::string> identity() override {
    if (const Status begun = begin_once(); !begun) return begun.error();
    return dialogue_.identity();
  }

  std::vector<Result<double>> read() override {
    if (const Status begun = begin_once(); !begun) return all(begun.error());
    std::vector<Result<double>> out;
    for (const config::QueryChannel& channel : device_.channels) {
      auto number = dialogue_.look(channel.query);
      if (!number && number.error().code != ErrorCode::kProtocol) {
        begun_ = false;  // it may have been switched off and on
        return all(number.error());
      }
      if (number) *number = *number * channel.scale + channel.offset;
      out.push_back(within(channel, std::move(number)));
    }
    return out;
  }

 private:
  Status begin_once() {
    if (begun_) return {};
    const Status begun = dialogue_.begin();
    begun_ = static_cast<bool>(begun);
    return begun;
  }

  ScpiDialogue dialogue_;
  bool begun_ = false;
};

class HidSensor final : public Sensor<config::HidSensor> {
 public:
  HidSensor(std::string name, const config::HidSensor& device,
            std::unique_ptr<HidTransport> transport)
      : Sensor(std::move(name), device), transport_(std::move(transport)) {}

  std::vector<Result<double>> read() override {
    std::vector<std::uint8_t> report(device_.report_bytes);
    const auto size =
        transport_->read_report(report, 2 * from_seconds(device_.report_period.count()));
    if (!size) return all(size.error());
    if (*size != report.size() || (device_.report_id != 0 && report[0] != device_.report_id)) {
      return all(
          {ErrorCode::kProtocol, fmt::format("sent report {} of {} bytes, expected report {} of {}",
                                             report[0], *size, device_.report_id, report.size())});
    }
    std::vector<Result<double>> out;
    for (const config::FieldChannel& channel : device_.channels) {
      out.push_back(within(channel, read_field(channel.place(), device_.byte_order, report)));
    }
    return out;
  }

 private:
  std::unique_ptr<HidTransport> transport_;
};

class LineSensor final : public Sensor<config::LineSensor> {
 public:
  LineSensor(std::string name, const config::LineSensor& device,
             std::unique_ptr<SerialTransport> transport, Clock& clock)
      : Sensor(std::move(name), device), transport_(std::move(transport)), clock_(clock) {}

  std::vector<Result<double>> read() override {
    // The first whole line is waited for: the line has only just been opened.
    const Clock::Instant give_up = clock_.now() + 3 * from_seconds(device_.period.count());
    do {
      if (const Status drained = drain(); !drained) return all(drained.error());
      if (!line_) clock_.sleep_for(std::chrono::milliseconds{10});
    } while (!line_ && clock_.now() < give_up);
    if (!line_ || clock_.now() - came_at_ > from_seconds(device_.max_age.count())) {
      return all(
          {ErrorCode::kTimeout, fmt::format("no line within {} s", device_.max_age.count())});
    }
    std::vector<Result<double>> out;
    for (const config::LineChannel& channel : device_.channels) {
      auto number = number_at(channel.position);
      if (number) *number = *number * channel.scale + channel.offset;
      out.push_back(within(channel, std::move(number)));
    }
    return out;
  }

 private:
  /// Takes what has come; the newest whole line stays.
  Status drain() {
    std::array<std::byte, 512> bytes;
    for (;;) {
      const auto count = transport_->read_some(bytes);
      if (!count) {
        arrived_.clear();
        line_.reset();
        return count.error();
      }
      if (*count == 0) break;
      arrived_.append(reinterpret_cast<const char*>(bytes.data()), *count);
      const std::size_t end = arrived_.rfind('\n');
      if (end != std::string::npos) {
        const std::size_t before = end == 0 ? std::string::npos : arrived_.rfind('\n', end - 1);
        const std::size_t begin = before == std::string::npos ? 0 : before + 1;
        // The first piece after opening may be the end of a line.
        if (begin > 0 || whole_) {
          line_ = arrived_.substr(begin, end - begin);
          came_at_ = clock_.now();
        }
        whole_ = true;
        arrived_.erase(0, end + 1);
      }
      if (arrived_.size() > kLongestSensorLine) {
        arrived_.clear();
        whole_ = false;
      }
    }
    return {};
  }

  Result<double> number_at(std::size_t position) const {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < position; ++i) {
      begin = line_->find(device_.separator, begin);
      if (begin == std::string::npos) break;
      begin += device_.separator.size();
    }
    if (begin != std::string::npos) {
      begin = line_->find_first_not_of(" \t+", begin);
      double value = 0.0;
      const char* const first = line_->data() + std::min(begin, line_->size());
      const auto [end, error] = std::from_chars(first, line_->data() + line_->size(), value);
      if (error == std::errc{} && std::isfinite(value)) return value;
    }
    return Error{ErrorCode::kProtocol, fmt::format("has no number at position {} of \"{}\"",
                                                   position, config::one_line(*line_))};
  }

  std::unique_ptr<SerialTransport> transport_;
  Clock& clock_;
  std::string arrived_;
  bool whole_ = false;  ///< what arrives next begins a line
  std::optional<std::string> line_;
  Clock::Instant came_at_{};
};

using Attached = Result<std::unique_ptr<AuxiliarySensor>>;

Attached attach(const std::string& name, const config::ModbusSensor& device,
                std::unique_ptr<ModbusTransport> transport, Clock& /*clock*/) {
  return Attached(std::make_unique<ModbusSensor>(name, device, std::move(transport)));
}
Attached attach(const std::string& name, const config::ScpiSensor& device,
                std::unique_ptr<MessageTransport> transport, Clock& clock) {
  auto dialogue = ScpiDialogue::attach(name, device.dialogue(), std::move(transport), clock);
  if (!dialogue) return dialogue.error();
  return Attached(std::make_unique<ScpiSensor>(name, device, std::move(*dialogue)));
}
Attached attach(const std::string& name, const config::HidSensor& device,
                std::unique_ptr<HidTransport> transport, Clock& /*clock*/) {
  return Attached(std::make_unique<HidSensor>(name, device, std::move(transport)));
}
Attached attach(const std::string& name, const config::LineSensor& device,
                std::unique_ptr<SerialTransport> transport, Clock& clock) {
  return Attached(std::make_unique<LineSensor>(name, device, std::move(transport), clock));
}

}  // namespace

Result<std::unique_ptr<AuxiliarySensor>> attach_sensor(const config::AuxiliaryConfig& config,
                                                       SensorTransport transport, Clock& clock) {
  const auto attach_to = [&]<class Device, class Transport>(const Device& device,
                                                            Transport& way) -> Attached {
    if constexpr (requires { attach(config.name, device, std::move(way), clock); }) {
      if (way != nullptr) return attach(config.name, device, std::move(way), clock);
    }
    return Error{ErrorCode::kBadInput, config.name + ": is not connected to anything of its kind"};
  };
  return std::visit(attach_to, config.device, transport);
}

}  // namespace fogbench::drivers
