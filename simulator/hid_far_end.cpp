#include "simulator/hid_far_end.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/number_codec.hpp"

namespace fogbench::simulator {

using config::FieldSpec;
using config::NumberType;

namespace {

bool is_field(const FieldSpec& spec) {
  return spec.name.starts_with("field_");
}

/// How far a counter of this type counts before it starts again from 0.
double modulus_of(NumberType type) {
  switch (type) {
    case NumberType::kUint8:
      return 0x1p8;
    case NumberType::kInt8:
      return 0x1p7;
    case NumberType::kUint16:
      return 0x1p16;
    case NumberType::kInt16:
      return 0x1p15;
    case NumberType::kUint32:
      return 0x1p32;
    case NumberType::kInt32:
      return 0x1p31;
    case NumberType::kFloat32:
      return 0x1p24;
  }
  return 1.0;
}

}  // namespace

HidFarEnd::HidFarEnd(const config::HidDevice& device, const config::MagneticPlant& plant,
                     InstrumentLine line, std::uint64_t seed)
    : device_(device), plant_config_(plant), line_(std::move(line)), seed_(seed) {}

std::int64_t HidFarEnd::newest() const {
  return static_cast<std::int64_t>(
      std::floor(line_.plant().now_s() / device_.report_period.count() + 1e-9));
}

Result<std::size_t> HidFarEnd::read_report(std::span<std::uint8_t> out,
                                           drivers::Clock::Duration timeout) {
  line_.begin("report");
  if (line_.fault(FaultKind::kUnplug)) return Error{ErrorCode::kUnplugged, "unplugged"};
  if (out.size() < device_.report_bytes) {
    return Error{ErrorCode::kProtocol, fmt::format("a report has {} bytes, room for {}",
                                                   device_.report_bytes, out.size())};
  }
  const bool in_vain = line_.fault(FaultKind::kTimeout) || line_.fault(FaultKind::kLateAnswer);
  if (in_vain) {
    line_.clock().sleep_for(timeout);
  } else if (line_.fault(FaultKind::kSlowAnswer)) {
    line_.clock().sleep_for(timeout * 9 / 10);
  } else if (newest() <= last_read_) {
    const double next_s = static_cast<double>(last_read_ + 1) * device_.report_period.count();
    const auto wait = drivers::from_seconds(next_s - line_.plant().now_s());
    line_.clock().sleep_for(std::min(wait, timeout));
  }
  line_.plant().advance();
  const std::int64_t number = newest();
  if (number <= last_read_ || in_vain) return Error{ErrorCode::kTimeout, "no report"};
  last_read_ = number;
  encode(number, out.first(device_.report_bytes));
  return device_.report_bytes;
}

Vector3 HidFarEnd::measure(std::int64_t number) {
  // A generator of each report's own: what one report shows does not depend on which were read.
  NormalSource noise(derive_seed(seed_, static_cast<std::uint64_t>(number)));
  const Vector3 field = line_.plant().field_ut();
  const double range = device_.range.value;
  Vector3 reported;
  for (std::size_t i = 0; i < 3; ++i) {
    reported[i] = plant_config_.sensor_offset_ut[i] + plant_config_.sensor_noise.value * noise();
    for (std::size_t j = 0; j < 3; ++j) {
      reported[i] += plant_config_.sensor_matrix[i][j] * field[j];
    }
    if (range > 0.0) reported[i] = std::clamp(reported[i], -range, range);
  }
  if (!line_.fault(FaultKind::kStuck) || !last_measured_) last_measured_ = reported;
  return *last_measured_;
}

void HidFarEnd::encode(std::int64_t number, std::span<std::uint8_t> report) {
  std::fill(report.begin(), report.end(), std::uint8_t{0});
  const Vector3 reported = measure(number);
  const bool wrong_count = line_.fault(FaultKind::kBadSequence);
  for (const FieldSpec& spec : device_.fields) {
    double value = spec.offset;
    if (spec.name == "sequence") {
      const double count = static_cast<double>(wrong_count ? number / 2 : number);
      value += spec.scale * std::fmod(count, modulus_of(spec.type));
    } else if (spec.name == "status" && line_.fault(FaultKind::kException)) {
      value += spec.scale;
    } else if (is_field(spec)) {
      value = reported[static_cast<std::size_t>(spec.name.back() - 'x') % 3];
    } else if (const auto measured = line_.plant().auxiliary(spec.name)) {
      value = *measured;
    }
    const bool no_number =
        spec.name != "sequence" && spec.name != "status" && line_.fault(FaultKind::kNan);
    if (no_number || !drivers::write_field(spec, device_.byte_order, value, report)) {
      const std::uint32_t nothing = spec.type == NumberType::kFloat32 ? 0x7FC00000U : 0x80000000U;
      const std::size_t bytes = drivers::byte_count(spec.type);
      const auto shift = static_cast<std::uint32_t>(32 - 8 * bytes);
      drivers::store_bytes(report.data() + spec.offset_bytes, bytes, device_.byte_order,
                           nothing >> shift);
    }
  }
  if (device_.report_id != 0) report[0] = device_.report_id;
  if (line_.fault(FaultKind::kGarbage)) {
    for (std::uint8_t& byte : report) byte = static_cast<std::uint8_t>(line_.random()());
  }
}

Status HidFarEnd::write_report(std::span<const std::uint8_t> report) {
  if (line_.fault(FaultKind::kUnplug)) return Error{ErrorCode::kUnplugged, "unplugged"};
  if (report.empty()) return Error{ErrorCode::kProtocol, "an empty report"};
  return {};
}

}  // namespace fogbench::simulator
