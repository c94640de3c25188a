#include "simulator/scpi_far_end.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <chrono>

namespace fogbench::simulator {
namespace {

using namespace std::chrono_literals;

constexpr drivers::Clock::Duration kMessage = 5ms;
constexpr drivers::Clock::Duration kWriteTimeout = 500ms;
constexpr std::string_view kValue = "{value}";
constexpr std::size_t kQueueLength = 20;

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

std::string_view trim(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

bool same(std::string_view command, const std::string& wanted) {
  return !wanted.empty() && command == upper(wanted);
}

bool is_one_of(std::string_view command, const std::vector<std::string>& all) {
  return std::any_of(all.begin(), all.end(),
                     [&](const std::string& known) { return same(command, known); });
}

/// "CURR" of "CURR {value}".
std::string header_of(const std::string& set_template) {
  return upper(trim(set_template.substr(0, set_template.find(kValue))));
}

}  // namespace

ScpiFarEnd::ScpiFarEnd(const config::ScpiDevice& device, std::unique_ptr<ScpiOutput> output,
                       InstrumentLine line)
    : device_(device), output_(std::move(output)), line_(std::move(line)) {}

std::string_view ScpiFarEnd::operation_of(std::string_view message) const {
  const std::string command = upper(trim(message));
  if (same(command, device_.error_query)) return "error_query";
  if (command == "*IDN?") return "identify";
  if (same(command, device_.set_query)) return "set_query";
  if (same(command, device_.measure_query)) return "measure";
  if (same(command, device_.output_on)) return "output_on";
  if (same(command, device_.output_off)) return "output_off";
  if (is_one_of(command, device_.initialise)) return "initialise";
  return command.substr(0, command.find_first_of(" \t")) == header_of(device_.set) ? "set" : "";
}

Status ScpiFarEnd::write(std::string_view message) {
  line_.begin(operation_of(message));
  if (Status s = line_.request(kMessage, kWriteTimeout); !s) return s;
  if (hears_) hears_(message);
  output_->open_circuit(line_.plant(), line_.fault(FaultKind::kOpenCircuit));
  if (answer_) fail(-410, "Query INTERRUPTED");
  answer_.reset();
  while (!message.empty()) {
    const std::size_t end = std::min(message.find(';'), message.size());
    if (const std::string_view command = trim(message.substr(0, end)); !command.empty()) {
      execute(command);
    }
    message.remove_prefix(std::min(end + 1, message.size()));
  }
  return {};
}

void ScpiFarEnd::execute(std::string_view text) {
  const std::string command = upper(text);
  if (same(command, device_.error_query)) return answer(next_error());
  if (command == "*CLS") return errors_.clear();
  if (line_.fault(FaultKind::kException)) return fail(-200, "Execution error");

  const std::string header = command.substr(0, command.find_first_of(" \t"));
  const std::string argument(trim(std::string_view(command).substr(header.size())));
  if (command == "*IDN?") {
    answer(device_.identity);
  } else if (command == "*RST") {
    output_->switch_output(line_.plant(), false);
  } else if (same(command, device_.set_query)) {
    answer(number(output_->setpoint(), last_setpoint_));
  } else if (same(command, device_.measure_query)) {
    answer(number(output_->measure(line_.plant()), last_measurement_));
  } else if (same(command, device_.output_on)) {
    output_->switch_output(line_.plant(), true);
  } else if (same(command, device_.output_off)) {
    output_->switch_output(line_.plant(), false);
  } else if (!device_.set.empty() && header == header_of(device_.set)) {
    set(argument);
  } else if (const auto measured = output_->answer_to(line_.plant(), text)) {
    answer(number(*measured, last_measurement_));
  } else if (!is_one_of(command, device_.initialise)) {
    fail(-113, "Undefined header");
  }
}

void ScpiFarEnd::set(std::string_view argument) {
  if (argument.empty()) return fail(-109, "Missing parameter");
  if (argument.front() == '+') argument.remove_prefix(1);
  double value = 0.0;
  const auto [end, code] =
      std::from_chars(argument.data(), argument.data() + argument.size(), value);
  if (code != std::errc{} || end != argument.data() + argument.size()) {
    return fail(-120, "Numeric data error");
  }
  value *= device_.scale;
  if (!(value >= device_.minimum && value <= device_.maximum)) {
    return fail(-222, "Data out of range");
  }
  output_->set(line_.plant(), value);
}

std::string ScpiFarEnd::number(double value, std::optional<std::string>& last) {
  constexpr const char* kNotANumber = "9.91E37";  // SCPI-99, 7.2.1.5
  if (line_.fault(FaultKind::kNan)) return kNotANumber;
  if (!line_.fault(FaultKind::kStuck) || !last) last = fmt::format("{:.6E}", value / device_.scale);
  return *last;
}

void ScpiFarEnd::answer(std::string text) {
  if (line_.fault(FaultKind::kGarbage)) {
    for (char& c : text) c = static_cast<char>(line_.random()() & 0x7FU);
  }
  answer_ = answer_ ? *answer_ + ";" + text : std::move(text);
}

void ScpiFarEnd::fail(int number, const char* meaning) {
  if (errors_.size() + 1 < kQueueLength) {
    errors_.push_back(fmt::format("{},\"{}\"", number, meaning));
  } else if (errors_.size() < kQueueLength) {
    errors_.push_back("-350,\"Queue overflow\"");
  }
}

std::string ScpiFarEnd::next_error() {
  if (errors_.empty()) return "0,\"No error\"";
  std::string first = std::move(errors_.front());
  errors_.pop_front();
  return first;
}

Result<std::string> ScpiFarEnd::read(drivers::Clock::Duration timeout) {
  if (Status s = line_.request(kMessage, timeout); !s) {
    answer_.reset();
    return s.error();
  }
  if (Status s = line_.answer(); !s) {
    answer_.reset();
    return s.error();
  }
  if (!answer_) {
    fail(-420, "Query UNTERMINATED");
    return line_.wait_in_vain();
  }
  std::string text = *std::move(answer_);
  answer_.reset();
  return text;
}

Result<std::uint8_t> ScpiFarEnd::read_status_byte() {
  if (Status s = line_.request(0ms, kWriteTimeout); !s) return s.error();
  constexpr std::uint8_t kMessageAvailable = 0x10;
  constexpr std::uint8_t kErrorAvailable = 0x04;
  return static_cast<std::uint8_t>((answer_ ? kMessageAvailable : 0) |
                                   (errors_.empty() ? 0 : kErrorAvailable));
}

Status ScpiFarEnd::clear() {
  line_.begin("clear");
  if (Status s = line_.request(kMessage, kWriteTimeout); !s) return s;
  answer_.reset();
  return {};
}

}  // namespace fogbench::simulator
