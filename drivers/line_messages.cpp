#include "drivers/line_messages.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;

constexpr Clock::Duration kLook = 2ms;
/// How late an answer may come that is still thrown away.
constexpr Clock::Duration kLate = 500ms;
/// SCPI answers of single values; a longer line is noise at a wrong rate.
constexpr std::size_t kLongestLine = 4096;
/// More than a line's buffer in the kernel holds.
constexpr std::size_t kMostDropped = std::size_t{1} << 17;

}  // namespace

Result<std::size_t> LineMessages::receive() {
  std::array<std::byte, 256> bytes;
  const auto count = serial_->read_some(bytes);
  if (!count) {
    arrived_.clear();
    return count;
  }
  for (std::size_t i = 0; i < *count; ++i) arrived_ += static_cast<char>(bytes[i]);
  return count;
}

Status LineMessages::drop() {
  for (std::size_t dropped = 0; dropped < kMostDropped;) {
    const auto count = receive();
    arrived_.clear();
    if (!count) return count.error();
    if (*count == 0) return {};
    dropped += *count;
  }
  return Error{ErrorCode::kProtocol, "does not stop sending"};
}

Status LineMessages::write(std::string_view message) {
  if (Status dropped = drop(); !dropped) return dropped;
  const std::string line = std::string(message) + '\n';
  return serial_->write(std::as_bytes(std::span(line)));
}

Result<std::string> LineMessages::read(Clock::Duration timeout) {
  const Clock::Instant give_up = clock_.now() + timeout;
  for (;;) {
    const auto count = receive();
    if (!count) return count.error();
    if (const std::size_t end = arrived_.find('\n'); end != std::string::npos) {
      std::string line = arrived_.substr(0, end);
      arrived_.erase(0, end + 1);
      if (line.ends_with('\r')) line.pop_back();
      return line;
    }
    if (arrived_.size() > kLongestLine) {
      arrived_.clear();
      return Error{ErrorCode::kProtocol,
                   fmt::format("sent {} bytes without an end of line", kLongestLine)};
    }
    if (*count > 0) continue;
    if (clock_.now() >= give_up) {
      arrived_.clear();
      return Error{ErrorCode::kTimeout, "no answer"};
    }
    clock_.sleep_for(kLook);
  }
}

Status LineMessages::clear() {
  const std::string end = "\n";
  if (Status sent = serial_->write(std::as_bytes(std::span(end))); !sent) return sent;
  for (const Clock::Instant until = clock_.now() + kLate; clock_.now() < until;) {
    if (Status dropped = drop(); !dropped) return dropped;
    clock_.sleep_for(kLook);
  }
  return {};
}

void LineMessages::write_last(std::string_view message) noexcept {
  const std::string line = '\n' + std::string(message) + '\n';  // ends what is half sent
  serial_->write_last(std::as_bytes(std::span(line)));
}

}  // namespace fogbench::drivers
