#include "simulator/gyro_far_end.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "drivers/number_codec.hpp"

namespace fogbench::simulator {

using config::NumberType;

namespace {

/// Just under the second of silence after which a stream counts as dead.
constexpr double kSlowAnswerS = 0.9;

/// A quiet one, in the bits of a float.
constexpr std::uint32_t kNotANumber = 0x7FC00000U;

/// The gyro stands on a table with X up: it weighs 1 g along it. Everything else reads 0.
double resting_value(const std::string& name) {
  return name == "acceleration_x" ? 1.0 : 0.0;
}

}  // namespace

GyroFarEnd::GyroFarEnd(const config::FrameDevice& device, const config::NoiseCoefficients& noise,
                       std::shared_ptr<Plant> plant, FaultSchedule faults, std::uint64_t seed)
    : device_(device),
      frame_bytes_(device.frame_bytes),
      frame_s_(1.0 / device.frame_rate_hz),
      plant_(std::move(plant)),
      faults_(std::move(faults)),
      noise_(noise, frame_s_, derive_seed(seed, "gyro noise")),
      quantiser_(noise.quantisation_deg, frame_s_),
      crc_(device.crc),
      garbage_(derive_seed(seed, "gyro garbage")),
      template_(frame_bytes_),
      last_rate_(drivers::byte_count(device.rate.type)),
      last_sequence_(drivers::byte_count(device.sequence_type)) {
  std::copy(device_.header.begin(), device_.header.end(), template_.begin());
  if (device_.status_offset_bytes) {
    template_[*device_.status_offset_bytes] = device_.status_valid_mask;
  }
  for (const config::FieldSpec& field : device_.others) {
    // A field that cannot hold its resting value stays 0.
    (void)drivers::write_field(field, device_.byte_order, resting_value(field.name), template_);
  }
}

Result<std::size_t> GyroFarEnd::read_some(std::span<std::byte> out) {
  plant_->advance();
  auto* const begin = reinterpret_cast<std::uint8_t*>(out.data());
  std::uint8_t* to = begin;
  std::uint8_t* const end = begin + out.size();
  const std::int64_t complete = complete_frames();
  skip_lost();
  const bool has_faults = !faults_.empty();
  if (has_faults) {
    make_with_faults(complete);
    if (faults_.active(FaultKind::kUnplug, plant_->now_s())) {
      return Error{ErrorCode::kUnplugged, "unplugged"};
    }
  }
  while (to != end) {
    if (pending_sent_ < pending_arrived_) {
      const std::size_t count =
          std::min(pending_arrived_ - pending_sent_, static_cast<std::size_t>(end - to));
      to = std::copy_n(pending_.data() + pending_sent_, count, to);
      pending_sent_ += count;
    } else if (has_faults || next_ >= complete) {
      break;
    } else if (static_cast<std::size_t>(end - to) >= frame_bytes_) {
      make_frame(to);
      to += frame_bytes_;
    } else {
      pending_.resize(frame_bytes_);
      make_frame(pending_.data());
      pending_arrived_ = frame_bytes_;
      pending_sent_ = 0;
    }
  }
  if (pending_sent_ == pending_.size()) {
    pending_.clear();
    pending_sent_ = pending_arrived_ = 0;
  }
  return static_cast<std::size_t>(to - begin);
}

void GyroFarEnd::make_with_faults(std::int64_t complete) {
  while (next_ < complete) {
    const double time_s = static_cast<double>(next_) * frame_s_;
    faults_.begin("frame");
    const bool slow = faults_.active(FaultKind::kSlowAnswer, time_s);
    const bool held_back = slow || faults_.active(FaultKind::kLateAnswer, time_s);
    if (!held_back) {
      held_back_since_s_.reset();
    } else if (!held_back_since_s_) {
      held_back_since_s_ = time_s;
    }
    const std::size_t start = pending_.size();
    pending_.resize(start + frame_bytes_);
    make_frame(pending_.data() + start);
    if (!spoil(pending_.data() + start, time_s)) pending_.resize(start);
    if (!held_back || (slow && time_s - *held_back_since_s_ >= kSlowAnswerS)) {
      pending_arrived_ = pending_.size();
      held_back_since_s_.reset();
    }
  }
}

void GyroFarEnd::exchange() {
  plant_->exchange_gyro();
  for (const std::int64_t complete = complete_frames(); next_ < complete; ++next_) noise_.next();
  step_end_ = 0;
  sequence_ = 0;
  pending_.clear();
  pending_sent_ = pending_arrived_ = 0;
  held_back_since_s_.reset();
}

Status GyroFarEnd::write(std::span<const std::byte>) {
  return {};
}

std::int64_t GyroFarEnd::complete_frames() const {
  // A fast clock goes on while the plant advances: a frame whose middle the plant has not reached
  // comes with the next reading.
  const double by_clock = std::floor(plant_->now_s() / frame_s_ + 1e-6);
  const double by_plant = std::ceil(plant_->reached_s() / frame_s_ - 0.5);
  return static_cast<std::int64_t>(std::min(by_clock, by_plant));
}

void GyroFarEnd::skip_lost() {
  const double kept_s = static_cast<double>(plant_->first_kept_step()) * plant_->step_s();
  const auto first_kept = static_cast<std::int64_t>(std::ceil(kept_s / frame_s_));
  for (; next_ < first_kept; ++next_) {
    noise_.next();
    sequence_ = next_sequence();
  }
}

void GyroFarEnd::enter_step(std::int64_t step) {
  const GyroInput& input = plant_->gyro_input(step);
  step_rate_deg_per_h_ = input.rate_deg_per_h;
  // The first frame whose middle lies in a later step.
  const double step_end_s = static_cast<double>(step + 1) * plant_->step_s();
  step_end_ = static_cast<std::int64_t>(std::ceil(step_end_s / frame_s_ - 0.5));
  if (device_.temperature) {
    // A temperature that the field cannot hold keeps its last value.
    (void)drivers::write_field(*device_.temperature, device_.byte_order, input.temperature_c,
                               template_);
  }
  plant_->forget_before(step);
}

void GyroFarEnd::make_frame(std::uint8_t* out) {
  if (next_ >= step_end_) {
    const double middle_s = (static_cast<double>(next_) + 0.5) * frame_s_;
    enter_step(static_cast<std::int64_t>(middle_s / plant_->step_s()));
  }
  const double rate = quantiser_.quantise(step_rate_deg_per_h_ + noise_.next());
  std::memcpy(out, template_.data(), frame_bytes_);
  drivers::store_bytes(out + device_.sequence_offset_bytes,
                       drivers::byte_count(device_.sequence_type), device_.byte_order, sequence_);
  const std::span<std::uint8_t> frame(out, frame_bytes_);
  if (!drivers::write_field(device_.rate, device_.byte_order, rate, frame)) {
    say_invalid(out);  // over range
  }
  ++next_;
  sequence_ = next_sequence();
  crc_.store(out);
}

std::uint32_t GyroFarEnd::next_sequence() const {
  return static_cast<std::uint32_t>((std::uint64_t{sequence_} + 1) % device_.sequence_modulus);
}

void GyroFarEnd::say_invalid(std::uint8_t* frame) const {
  if (device_.status_offset_bytes) {
    frame[*device_.status_offset_bytes] = 0;
  } else if (device_.rate.type == NumberType::kFloat32) {
    drivers::store_bytes(frame + device_.rate.offset_bytes, sizeof(float), device_.byte_order,
                         kNotANumber);
  }  // else it cannot say so
}

bool GyroFarEnd::spoil(std::uint8_t* frame, double time_s) {
  const auto active = [&](FaultKind kind) { return faults_.active(kind, time_s); };
  if (active(FaultKind::kTimeout) || active(FaultKind::kUnplug)) return false;
  std::uint8_t* const rate = frame + device_.rate.offset_bytes;
  if (active(FaultKind::kStuck)) {
    std::memcpy(rate, last_rate_.data(), last_rate_.size());
  } else {
    std::memcpy(last_rate_.data(), rate, last_rate_.size());
  }
  if (active(FaultKind::kException)) say_invalid(frame);
  if (active(FaultKind::kNan)) {
    if (device_.rate.type == NumberType::kFloat32) {
      drivers::store_bytes(rate, sizeof(float), device_.byte_order, kNotANumber);
    } else {
      say_invalid(frame);
    }
  }
  std::uint8_t* const sequence = frame + device_.sequence_offset_bytes;
  if (active(FaultKind::kBadSequence)) {
    std::memcpy(sequence, last_sequence_.data(), last_sequence_.size());
  } else {
    std::memcpy(last_sequence_.data(), sequence, last_sequence_.size());
  }
  crc_.store(frame);
  if (active(FaultKind::kBadChecksum)) frame[device_.crc.offset_bytes] ^= 0x01U;
  if (active(FaultKind::kGarbage)) {
    std::generate_n(frame, frame_bytes_, [this] { return static_cast<std::uint8_t>(garbage_()); });
  }
  return true;
}

}  // namespace fogbench::simulator
