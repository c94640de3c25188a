#include "simulator/line_far_end.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace fogbench::simulator {

Result<std::size_t> LineFarEnd::read_some(std::span<std::byte> out) {
  line_.begin("read");
  line_.plant().advance();
  if (!plugged() || line_.fault(FaultKind::kUnplug)) {
    pending_.clear();
    return Error{ErrorCode::kUnplugged, "unplugged"};
  }
  const auto due =
      static_cast<std::int64_t>(std::floor(line_.plant().now_s() / sensor_.period.count() + 1e-9));
  if (due > sent_) {
    sent_ = due;
    if (!line_.fault(FaultKind::kTimeout)) pending_ += make_line();
  }
  const std::size_t count = std::min(out.size(), pending_.size());
  std::memcpy(out.data(), pending_.data(), count);
  pending_.erase(0, count);
  return count;
}

std::string LineFarEnd::make_line() {
  std::size_t last = 0;
  for (const auto& channel : sensor_.channels) last = std::max<std::size_t>(last, channel.position);
  std::vector<std::string> numbers(last + 1, "0");
  for (const config::LineChannel& channel : sensor_.channels) {
    const double value = line_.plant().auxiliary(channel.name).value_or(0.0);
    numbers[channel.position] =
        line_.fault(FaultKind::kNan)
            ? std::string("---")
            : fmt::format("{:.6g}", (value - channel.offset) / channel.scale);
  }
  std::string line = fmt::format("{}\r\n", fmt::join(numbers, sensor_.separator));
  if (line_.fault(FaultKind::kGarbage)) {
    for (char& c : line) c = static_cast<char>(line_.random()() & 0x7FU);
  }
  return line;
}

Status LineFarEnd::write(std::span<const std::byte> /*bytes*/) {
  if (!plugged()) return Error{ErrorCode::kUnplugged, "unplugged"};
  return {};
}

}  // namespace fogbench::simulator
