#include "drivers/serial_gyro.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/named_error.hpp"

namespace fogbench::drivers {
namespace {

using namespace std::chrono_literals;

/// A gyro sends without pause: a second without a frame is silence, or ten periods of a slow one.
constexpr Clock::Duration kLongestSilence = 1s;
constexpr double kLongestSilencePeriods = 10.0;

/// On a busy machine frames come late, and then all together: what seems to be lost is looked for
/// again, for half a second, before it counts as lost. Counted in looks: while this program gets no
/// time, others get none to send.
constexpr int kMostLooks = 100;
constexpr Clock::Duration kLookAgain = 5ms;

/// A line that never runs empty must not hold the caller for ever: no more is taken at once than
/// this, and twice what is due since the last time.
constexpr std::size_t kMostBytes = std::size_t{1} << 20;

}  // namespace

SerialGyro::SerialGyro(std::string name, const config::GyroConfig& config,
                       std::unique_ptr<SerialTransport> transport, Clock& clock)
    : name_(std::move(name)),
      device_(config.device),
      identity_(config.device.name),
      frame_rate_hz_(config.device.frame_rate_hz),
      bytes_per_s_(config.device.frame_rate_hz * config.device.frame_bytes),
      longest_silence_(
          std::max(kLongestSilence, from_seconds(kLongestSilencePeriods / frame_rate_hz_))),
      transport_(std::move(transport)),
      clock_(clock),
      parser_(config.device),
      meter_(frame_rate_hz_),
      last_read_(clock.now()) {}

Result<std::unique_ptr<SerialGyro>> SerialGyro::attach(std::string name,
                                                       const config::GyroConfig& config,
                                                       std::unique_ptr<SerialTransport> transport,
                                                       Clock& clock) {
  if (const Status layout = check_layout(config.device); !layout) {
    return named(name, layout.error());
  }
  return std::unique_ptr<SerialGyro>(
      new SerialGyro(std::move(name), config, std::move(transport), clock));
}

Status SerialGyro::begin() {
  for (std::size_t discarded = 0; discarded < kMostBytes;) {
    const auto count = transport_->read_some(parser_.space());
    if (!count) return named(name_, count.error());
    if (*count == 0) break;
    discarded += *count;
  }
  // Looking four times a period ties index to clock to a quarter of a period.
  const Clock::Duration pause = from_seconds(0.25 / frame_rate_hz_);
  last_good_ = clock_.now();
  for (GyroBlock first; first.index.empty();) {
    clock_.sleep_for(pause);
    if (Status status = read(first); !status) return status;
  }
  first_sample_ =
      last_good_ - from_seconds((static_cast<double>(parser_.last_index()) + 0.5) / frame_rate_hz_);
  return {};
}

Status SerialGyro::begin_anew(Clock::Instant switched_on) {
  before_ = statistics_;
  parser_ = FrameParser(device_);
  meter_ = FrameRateMeter(frame_rate_hz_);
  unheard_ = 0;
  last_read_ = clock_.now();
  bytes_since_good_ = 0;
  if (Status begun = begin(); !begun) return begun;
  const double earlier_s = to_seconds(first_sample_ - switched_on);
  unheard_ = std::max<std::int64_t>(0, std::llround(earlier_s * frame_rate_hz_ - 0.5));
  first_sample_ -= from_seconds(static_cast<double>(unheard_) / frame_rate_hz_);
  return {};
}

Result<bool> SerialGyro::take(GyroBlock& out) {
  const Clock::Instant now = clock_.now();
  const double due_bytes = to_seconds(now - std::exchange(last_read_, now)) * bytes_per_s_;
  const std::size_t most = kMostBytes + static_cast<std::size_t>(2.0 * due_bytes);
  for (std::size_t total = 0; total < most;) {
    const auto count = transport_->read_some(parser_.space());
    if (!count) return named(name_, count.error());
    if (*count == 0) return true;
    parser_.parse(*count, out);
    total += *count;
    bytes_since_good_ += *count;
  }
  return false;
}

Status SerialGyro::read(GyroBlock& out) {
  const std::uint64_t good_before = parser_.statistics().frames_good;
  const std::size_t entries_before = out.index.size();
  auto empty = take(out);
  Clock::Instant now = clock_.now();
  for (int looks = 0; looks < kMostLooks && empty && *empty && parser_.misses_turns(now);
       ++looks, now = clock_.now()) {
    clock_.sleep_for(kLookAgain);
    empty = take(out);
  }
  if (empty && *empty) meter_.look(now, parser_.counted());
  const Status failure = empty ? Status{} : empty.error();
  parser_.settle(empty && *empty ? std::optional(now) : std::nullopt, out);
  for (std::size_t i = entries_before; i < out.index.size(); ++i) out.index[i] += unheard_;
  statistics_ = before_ + parser_.statistics();
  if (!failure) return failure;
  if (parser_.statistics().frames_good > good_before) {
    last_good_ = now;
    bytes_since_good_ = 0;
    return {};
  }
  if (now - last_good_ <= longest_silence_) return {};
  const double silence = to_seconds(now - last_good_);
  if (bytes_since_good_ == 0) {
    return Error{ErrorCode::kTimeout, fmt::format("{}: no frame for {:.1f} s, expected {} a second",
                                                  name_, silence, frame_rate_hz_)};
  }
  return Error{
      ErrorCode::kProtocol,
      fmt::format("{}: {} bytes in {:.1f} s but no good frame ({} with a wrong check value,"
                  " {} invalid so far{})",
                  name_, bytes_since_good_, silence, parser_.statistics().frames_bad_checksum,
                  parser_.statistics().frames_invalid,
                  parser_.stands_still() ? "; the rate stands still" : "")};
}

Clock::Instant SerialGyro::time_of(std::int64_t index) const {
  return first_sample_ + from_seconds(static_cast<double>(index) / frame_rate_hz_);
}

}  // namespace fogbench::drivers
