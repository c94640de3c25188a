#include "drivers/hid_magnetometer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "drivers/named_error.hpp"
#include "drivers/number_codec.hpp"

namespace fogbench::drivers {
namespace {

constexpr const char* kAxisNames[] = {"field_x", "field_y", "field_z"};

/// A converter at its stop reads the end of the range; rounding must not hide that.
constexpr double kRoundingOfRange = 1e-6;

/// How far a counter of this type counts before it starts again from 0.
double turn_of(NumberType type) {
  switch (type) {
    case NumberType::kFloat32:
      return 0x1p24;  // beyond it a float has no odd numbers
    case NumberType::kInt8:
    case NumberType::kInt16:
    case NumberType::kInt32:
      return std::ldexp(1.0, static_cast<int>(8 * byte_count(type)) - 1);
    default:
      return std::ldexp(1.0, static_cast<int>(8 * byte_count(type)));
  }
}

}  // namespace

HidMagnetometer::HidMagnetometer(std::string name, config::HidDevice device,
                                 std::unique_ptr<HidTransport> transport, Clock& clock)
    : name_(std::move(name)),
      device_(std::move(device)),
      transport_(std::move(transport)),
      clock_(clock),
      stillness_(device_.stuck_after) {
  const auto find = [&](std::string_view wanted) -> const config::FieldSpec* {
    const auto found = std::find_if(device_.fields.begin(), device_.fields.end(),
                                    [&](const auto& field) { return field.name == wanted; });
    return found == device_.fields.end() ? nullptr : &*found;
  };
  for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i] = find(kAxisNames[i]);
  sequence_ = find("sequence");
  status_ = find("status");
}

Result<std::unique_ptr<HidMagnetometer>> HidMagnetometer::attach(
    std::string name, const config::HidDevice& device, std::unique_ptr<HidTransport> transport,
    Clock& clock) {
  std::unique_ptr<HidMagnetometer> magnetometer(
      new HidMagnetometer(std::move(name), device, std::move(transport), clock));
  if (const Status layout = magnetometer->check_layout(); !layout) return layout.error();
  return magnetometer;
}

Status HidMagnetometer::begin() {
  const auto first = read();
  return first ? Status{} : first.error();
}

Error HidMagnetometer::error(ErrorCode code, const std::string& message) const {
  return {code, name_ + ": " + message};
}

Status HidMagnetometer::check_layout() {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (axes_[i] == nullptr) {
      return error(ErrorCode::kBadInput,
                   fmt::format("the report of {} has no field {}", device_.name, kAxisNames[i]));
    }
  }
  for (const config::FieldSpec& field : device_.fields) {
    const std::size_t end = field.offset_bytes + byte_count(field.type);
    if (end > device_.report_bytes) {
      return error(ErrorCode::kBadInput,
                   fmt::format("field {} ends at byte {} of a report of {} bytes", field.name, end,
                               device_.report_bytes));
    }
  }
  return {};
}

bool HidMagnetometer::is_new(const std::vector<std::uint8_t>& report) const {
  if (last_.empty()) return true;
  if (sequence_ == nullptr) return report != last_;
  const auto begin = report.begin() + sequence_->offset_bytes;
  const auto end = begin + static_cast<std::ptrdiff_t>(byte_count(sequence_->type));
  return !std::equal(begin, end, last_.begin() + sequence_->offset_bytes);
}

Result<FieldReading> HidMagnetometer::read() {
  std::vector<std::uint8_t> report(device_.report_bytes);
  const Clock::Instant give_up = clock_.now() + from_seconds(device_.max_age.count());
  for (;;) {
    const Clock::Duration patience = std::max(give_up - clock_.now(), Clock::Duration::zero());
    const auto size = transport_->read_report(report, patience);
    if (!size) return named(name_, size.error());
    if (*size != report.size()) {
      return error(ErrorCode::kProtocol,
                   fmt::format("sent a report of {} bytes, expected {}", *size, report.size()));
    }
    if (device_.report_id != 0 && report[0] != device_.report_id) {
      return error(ErrorCode::kProtocol,
                   fmt::format("sent report {}, expected report {}", report[0], device_.report_id));
    }
    if (is_new(report)) break;
    if (clock_.now() >= give_up) {
      return error(ErrorCode::kStale,
                   fmt::format("has repeated one report for {} s", device_.max_age.count()));
    }
    clock_.sleep_until(
        std::min(give_up, clock_.now() + from_seconds(device_.report_period.count())));
  }
  // One that has restarted counts from 0 too: the next report is good again.
  const bool old = goes_back(report);
  last_ = report;
  last_at_ = clock_.now();
  if (old) return error(ErrorCode::kStale, "the count of its reports went back");
  return decode(report);
}

bool HidMagnetometer::goes_back(const std::vector<std::uint8_t>& report) const {
  if (sequence_ == nullptr || last_.empty()) return false;
  const double turn = turn_of(sequence_->type);
  // After half a turn of silence ahead and back look the same.
  const double due = to_seconds(clock_.now() - last_at_) / device_.report_period.count();
  if (due > 0.5 * turn) return false;
  const auto count = [&](const std::vector<std::uint8_t>& from) {
    return raw_from_bits(sequence_->type,
                         load_bytes(from.data() + sequence_->offset_bytes,
                                    byte_count(sequence_->type), device_.byte_order));
  };
  const double ahead = count(report) - count(last_);
  return !((ahead < 0 ? ahead + turn : ahead) <= 0.5 * turn);  // a NaN is no count either
}

Result<FieldReading> HidMagnetometer::decode(std::span<const std::uint8_t> report) {
  if (status_ != nullptr) {
    const auto status = read_field(*status_, device_.byte_order, report);
    if (!status) return named(name_, status.error());
    if (*status != 0) {
      return error(ErrorCode::kDevice, fmt::format("its status is {}, expected 0", *status));
    }
  }
  std::array<double, 3> centred_ut{};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto value = read_field(*axes_[i], device_.byte_order, report);
    if (!value) return named(name_, value.error());
    if (std::abs(*value) >= device_.range.value * (1.0 - kRoundingOfRange)) {
      return error(ErrorCode::kDevice,
                   fmt::format("{} reads {} uT: saturated at its range of {} uT", axes_[i]->name,
                               *value, device_.range.value));
    }
    centred_ut[i] = *value - device_.calibration_offset_ut[i];
  }
  const auto still = stillness_.add(centred_ut, clock_.now());
  if (still) {
    return error(ErrorCode::kStale,
                 fmt::format("no axis has moved by a bit for {:.1f} s", still->count()));
  }
  FieldReading reading;
  reading.taken_at = clock_.now();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    double field_ut = 0.0;
    for (std::size_t j = 0; j < axes_.size(); ++j) {
      field_ut += device_.calibration_matrix[i][j] * centred_ut[j];
    }
    reading.field[i] = Microtesla{field_ut};
  }
  return reading;
}

}  // namespace fogbench::drivers
