#pragma once
// Listens in between drivers and instruments: every request and every answer, in order, condensed
// to a number.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "drivers/transport.hpp"

namespace fogbench::support {

/// FNV-1a of what went over the wires.
class WireTrace {
 public:
  void add(std::string_view bytes) {
    for (const char c : bytes) hash_ = (hash_ ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
  }
  template <class T>
  void add(std::span<T> values) {
    add(std::string_view(reinterpret_cast<const char*>(values.data()), values.size_bytes()));
  }
  void add(const Status& status) { add(status ? std::string("ok") : status.error().message); }
  std::uint64_t hash() const { return hash_; }
  void say(std::string_view message) {
    add(message);
    (text_ += message) += '\n';
  }
  const std::string& text() const { return text_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325U;
  std::string text_;
};

/// The same for all kinds of transport: what is behind, and where it is noted.
template <class Transport>
class TapOf : public Transport {
 public:
  TapOf(std::unique_ptr<Transport> behind, WireTrace& trace)
      : behind_(std::move(behind)), trace_(trace) {}

 protected:
  std::unique_ptr<Transport> behind_;
  WireTrace& trace_;
};

class ModbusTap final : public TapOf<drivers::ModbusTransport> {
 public:
  using TapOf::TapOf;
  Status read_registers(std::uint16_t address, std::span<std::uint16_t> out) override {
    Status read = behind_->read_registers(address, out);
    trace_.add(std::span(&address, 1));
    trace_.add(read);
    trace_.add(out);
    return read;
  }
  Status write_registers(std::uint16_t address, std::span<const std::uint16_t> values) override {
    Status written = behind_->write_registers(address, values);
    trace_.add(std::span(&address, 1));
    trace_.add(written);
    trace_.add(values);
    return written;
  }
};

class MessageTap final : public TapOf<drivers::MessageTransport> {
 public:
  using TapOf::TapOf;
  Status write(std::string_view message) override {
    trace_.say(message);
    return behind_->write(message);
  }
  Result<std::string> read(drivers::Clock::Duration timeout) override {
    auto answer = behind_->read(timeout);
    trace_.say(answer ? *answer : answer.error().message);
    return answer;
  }
  Status clear() override { return behind_->clear(); }
};

class HidTap final : public TapOf<drivers::HidTransport> {
 public:
  using TapOf::TapOf;
  Result<std::size_t> read_report(std::span<std::uint8_t> out,
                                  drivers::Clock::Duration timeout) override {
    auto size = behind_->read_report(out, timeout);
    trace_.add(out);
    return size;
  }
  Status write_report(std::span<const std::uint8_t> report) override {
    trace_.add(report);
    return behind_->write_report(report);
  }
};

class SerialTap final : public TapOf<drivers::SerialTransport> {
 public:
  using TapOf::TapOf;
  Result<std::size_t> read_some(std::span<std::byte> out) override {
    auto count = behind_->read_some(out);
    if (count) trace_.add(out.first(*count));
    return count;
  }
  Status write(std::span<const std::byte> bytes) override {
    trace_.add(bytes);
    return behind_->write(bytes);
  }
};

inline std::unique_ptr<drivers::ModbusTransport> tapped(
    std::unique_ptr<drivers::ModbusTransport> end, WireTrace& trace) {
  return std::make_unique<ModbusTap>(std::move(end), trace);
}
inline std::unique_ptr<drivers::MessageTransport> tapped(
    std::unique_ptr<drivers::MessageTransport> end, WireTrace& trace) {
  return std::make_unique<MessageTap>(std::move(end), trace);
}
inline std::unique_ptr<drivers::HidTransport> tapped(std::unique_ptr<drivers::HidTransport> end,
                                                     WireTrace& trace) {
  return std::make_unique<HidTap>(std::move(end), trace);
}
inline std::unique_ptr<drivers::SerialTransport> tapped(
    std::unique_ptr<drivers::SerialTransport> end, WireTrace& trace) {
  return std::make_unique<SerialTap>(std::move(end), trace);
}

/// All of a bench's, each behind a tap on one trace.
inline drivers::Transports tapped(drivers::Transports ends, WireTrace& trace) {
  drivers::Transports out{.thermostat = tapped(std::move(ends.thermostat), trace),
                          .coil_horizontal = tapped(std::move(ends.coil_horizontal), trace),
                          .coil_vertical = tapped(std::move(ends.coil_vertical), trace),
                          .magnetometer = tapped(std::move(ends.magnetometer), trace),
                          .turntable = tapped(std::move(ends.turntable), trace),
                          .gyro = tapped(std::move(ends.gyro), trace)};
  for (drivers::SensorTransport& way : ends.auxiliary) {
    std::visit([&](auto& end) { out.auxiliary.emplace_back(tapped(std::move(end), trace)); }, way);
  }
  return out;
}

}  // namespace fogbench::support
