#include "drivers/frame_rate_meter.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fogbench::drivers {

void FrameRateMeter::look(Clock::Instant now, std::int64_t counted) {
  if (!origin_) {
    origin_ = now;
    counted_ = counted;
    span_.since = now;
    return;
  }
  if (counted == counted_) return;  // no new frame: nothing is known of its lateness
  counted_ = counted;
  span_.least_late_s = std::min(
      span_.least_late_s, to_seconds(now - *origin_) - static_cast<double>(counted) / stated_hz_);
  if (++looks_ < kLooks || now - span_.since < kSpan) return;
  if (complete_ == kSpans) {
    std::shift_left(spans_.begin(), spans_.end(), 1);
    --complete_;
  }
  spans_[complete_++] = span_;
  span_ = Span{now};
  looks_ = 0;
}

std::optional<FrameRate> FrameRateMeter::rate() const {
  if (complete_ < kSpans) return std::nullopt;
  std::array<double, kSpans - 1> growth{};  // of the lateness, s a second
  for (std::size_t i = 0; i < growth.size(); ++i) {
    growth[i] = (spans_[i + 1].least_late_s - spans_[i].least_late_s) /
                to_seconds(spans_[i + 1].since - spans_[i].since);
  }
  std::sort(growth.begin(), growth.end());
  const double median = growth[growth.size() / 2];
  // A frame more or less in a span shows: the mean of those in the middle is finer than the median.
  const double mean = std::accumulate(growth.begin() + 1, growth.end() - 1, 0.0) /
                      static_cast<double>(growth.size() - 2);
  const FrameRate rate{stated_hz_ * (1.0 - mean), std::abs(median) <= kTolerance};
  if (rate.as_stated) return rate;
  const auto alike = std::count_if(growth.begin(), growth.end(), [median](double g) {
    return std::abs(g - median) < 0.5 * std::abs(median);
  });
  // All but one, and that one may be anything.
  const bool beyond = growth[1] > kTolerance || growth[growth.size() - 2] < -kTolerance;
  if (beyond && alike + 1 >= static_cast<std::ptrdiff_t>(growth.size())) return rate;
  return std::nullopt;
}

}  // namespace fogbench::drivers
