#include "simulator/wire/modbus_rtu_server.hpp"

#include <chrono>

namespace fogbench::simulator {
namespace {

using namespace std::chrono_literals;

/// A frame ends with a silence of 3.5 characters, 4 ms at 9600 baud. A pseudo-terminal knows no
/// baud, and a busy host writes with pauses.
constexpr drivers::Clock::Duration kSilence = 50ms;
constexpr std::size_t kLongestFrame = 256;

}  // namespace

void ModbusRtuServer::enlist(drivers::PollSet& set) const {
  terminal_.enlist(set, POLLIN);
  if (!answer_.empty()) {
    set.wake_at(due_);
  } else if (!input_.empty()) {
    set.wake_at(std::max(heard_ + kSilence, unit_.busy_until()));
  }
}

void ModbusRtuServer::forget() {
  input_.clear();
  answer_.clear();
}

void ModbusRtuServer::serve(const drivers::PollSet&) {
  if (!unit_.plugged()) {
    forget();
    return terminal_.unplug();
  }
  if (!terminal_.plug()) return;  // At the next turn, perhaps.
  if (!terminal_.in_use()) return forget();
  const std::size_t before = input_.size();
  terminal_.receive(input_, kLongestFrame);
  if (input_.size() > before) heard_ = clock_.now();
  while (go_on()) {
  }
}

bool ModbusRtuServer::go_on() {
  if (!answer_.empty()) {
    if (clock_.now() < due_) return false;
    terminal_.send(answer_);  // What does not fit into the line is lost on it.
    answer_.clear();
  }
  if (input_.empty() || clock_.now() < unit_.busy_until()) return false;
  const std::optional<std::size_t> size = modbus_rtu_request_size(input_);
  if (size && input_.size() >= *size) {
    if (const auto frame = parse_modbus_rtu(ByteView(input_).first(*size))) {
      input_.erase(input_.begin(), input_.begin() + static_cast<std::ptrdiff_t>(*size));
      execute(*frame);
      return true;
    }
  }
  if (clock_.now() < heard_ + kSilence) return false;
  if (const auto frame = parse_modbus_rtu(input_)) execute(*frame);
  input_.clear();
  return true;
}

void ModbusRtuServer::execute(const ModbusFrame& frame) {
  constexpr std::uint8_t kEverybody = 0;  // is written to and does not answer
  if (frame.unit != unit_.id() && frame.unit != kEverybody) return;
  const ModbusAnswer answer = unit_.execute(frame.content);
  if (answer.gone) {
    forget();
    return terminal_.unplug();
  }
  if (frame.unit == kEverybody || answer.content.empty()) return;
  answer_ = encode_modbus_rtu(frame.unit, answer.content);
  if (answer.spoilt) answer_.back() ^= 0x01U;
  due_ = answer.due;
}

}  // namespace fogbench::simulator
