#pragma once
// Transports whose far end is a script, for the drivers' tests. Each is shared with its test by
// reference: the test keeps the state, the driver owns a thin handle to it.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/transport.hpp"

namespace fogbench::support {

/// A serial line: bytes that the test puts in come out, at most `chunk` at a time.
struct FakeLine {
  std::deque<std::byte> bytes;
  std::size_t chunk = SIZE_MAX;
  std::optional<Error> failure, write_failure;
  std::string written;
  /// Called before every read: puts in what would have arrived by now.
  std::function<void()> before_read;

  void put(std::span<const std::uint8_t> more) {
    for (const std::uint8_t byte : more) bytes.push_back(std::byte{byte});
  }
};

class FakeSerial final : public drivers::SerialTransport {
 public:
  explicit FakeSerial(FakeLine& line) : line_(line) {}
  Result<std::size_t> read_some(std::span<std::byte> out) override {
    if (line_.before_read) line_.before_read();
    if (line_.failure) return *line_.failure;
    const std::size_t count = std::min({out.size(), line_.chunk, line_.bytes.size()});
    const auto end = line_.bytes.begin() + static_cast<std::ptrdiff_t>(count);
    std::copy(line_.bytes.begin(), end, out.begin());
    line_.bytes.erase(line_.bytes.begin(), end);
    return count;
  }
  Status write(std::span<const std::byte> bytes) override {
    if (line_.write_failure) return *line_.write_failure;
    for (const std::byte byte : bytes) line_.written += static_cast<char>(byte);
    return {};
  }

 private:
  FakeLine& line_;
};

/// Holding registers. A planned failure is what the next read or write returns instead of success;
/// a write that fails may have been executed all the same.
struct FakeRegisters {
  struct WriteFailure {
    Error error;
    bool executed = false;
  };
  std::map<std::uint16_t, std::uint16_t> words;
  bool even_counts_only = false;
  std::deque<Error> read_failures;
  std::deque<WriteFailure> write_failures;
  /// Each read and write as "read 2+4", "write 2+1".
  std::vector<std::string> log;
  std::function<void()> before_read;

  std::size_t count(std::string_view prefix) const {
    return static_cast<std::size_t>(std::count_if(
        log.begin(), log.end(), [&](const std::string& line) { return line.starts_with(prefix); }));
  }
};

class FakeModbus final : public drivers::ModbusTransport {
 public:
  explicit FakeModbus(FakeRegisters& far) : far_(far) {}
  Status read_registers(std::uint16_t address, std::span<std::uint16_t> out) override {
    if (far_.before_read) far_.before_read();
    far_.log.push_back("read " + std::to_string(address) + "+" + std::to_string(out.size()));
    if (!far_.read_failures.empty()) return take(far_.read_failures);
    if (Status known = check(address, out.size()); !known) return known;
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = far_.words.at(static_cast<std::uint16_t>(address + i));
    }
    return {};
  }
  Status write_registers(std::uint16_t address, std::span<const std::uint16_t> values) override {
    far_.log.push_back("write " + std::to_string(address) + "+" + std::to_string(values.size()));
    std::optional<FakeRegisters::WriteFailure> failure;
    if (!far_.write_failures.empty()) failure = take(far_.write_failures);
    if (failure && !failure->executed) return failure->error;
    if (Status known = check(address, values.size()); !known) return known;
    for (std::size_t i = 0; i < values.size(); ++i) {
      far_.words[static_cast<std::uint16_t>(address + i)] = values[i];
    }
    return failure ? Status(failure->error) : Status{};
  }

 private:
  template <class T>
  static T take(std::deque<T>& queue) {
    T first = queue.front();
    queue.pop_front();
    return first;
  }
  Status check(std::uint16_t address, std::size_t count) const {
    bool answers = !far_.even_counts_only || count % 2 == 0;
    for (std::size_t i = 0; i < count; ++i) {
      answers = answers && far_.words.contains(static_cast<std::uint16_t>(address + i));
    }
    return answers ? Status{} : Error{ErrorCode::kDevice, "Modbus exception 2"};
  }
  FakeRegisters& far_;
};

/// A SCPI instrument: answers by question, and whatever `obey` does with a command.
struct FakeScpi {
  std::map<std::string, std::string> answers;
  std::deque<std::string> errors;  ///< the error queue
  std::function<void(const std::string&)> obey;
  /// What the next reads fail with; the answer that was due is lost, as after a drained time-out.
  std::deque<Error> read_failures;
  std::deque<Error> write_failures;
  std::function<void(const std::string&)> before_write;
  std::vector<std::string> sent;
  int clears = 0;

  bool was_sent(const std::string& text) const {
    return std::find(sent.begin(), sent.end(), text) != sent.end();
  }
};

class FakeMessages final : public drivers::MessageTransport {
 public:
  explicit FakeMessages(FakeScpi& far) : far_(far) {}
  Status write(std::string_view message) override {
    const std::string text(message);
    if (!far_.write_failures.empty()) {
      const Error failure = far_.write_failures.front();
      far_.write_failures.pop_front();
      return failure;
    }
    if (far_.before_write) far_.before_write(text);
    far_.sent.push_back(text);
    if (text == "SYST:ERR?") {
      due_ = far_.errors.empty() ? "0,\"No error\"" : far_.errors.front();
      if (!far_.errors.empty()) far_.errors.pop_front();
    } else if (text.ends_with('?')) {
      const auto answer = far_.answers.find(text);
      if (answer != far_.answers.end()) due_ = answer->second;
    } else if (far_.obey) {
      far_.obey(text);
    }
    return {};
  }
  Result<std::string> read(drivers::Clock::Duration) override {
    std::optional<std::string> answer;
    std::swap(answer, due_);
    if (!far_.read_failures.empty()) {
      const Error failure = far_.read_failures.front();
      far_.read_failures.pop_front();
      return failure;
    }
    if (!answer) return Error{ErrorCode::kTimeout, "no answer"};
    return *answer;
  }
  Status clear() override {
    ++far_.clears;
    due_.reset();
    return {};
  }

 private:
  FakeScpi& far_;
  std::optional<std::string> due_;
};

/// A HID device: the reports in turn, the last one again and again; none is a time-out.
struct FakeReports {
  std::deque<std::vector<std::uint8_t>> reports;
  std::optional<Error> failure;
};

class FakeHid final : public drivers::HidTransport {
 public:
  explicit FakeHid(FakeReports& far) : far_(far) {}
  Result<std::size_t> read_report(std::span<std::uint8_t> out, drivers::Clock::Duration) override {
    if (far_.failure) return *far_.failure;
    if (far_.reports.empty()) return Error{ErrorCode::kTimeout, "no report"};
    const std::vector<std::uint8_t> report = far_.reports.front();
    if (far_.reports.size() > 1) far_.reports.pop_front();
    std::copy_n(report.begin(), std::min(report.size(), out.size()), out.begin());
    return report.size();
  }
  Status write_report(std::span<const std::uint8_t>) override { return {}; }

 private:
  FakeReports& far_;
};

}  // namespace fogbench::support
