#include "acceptance/quiet_record.hpp"

#include <algorithm>
#include <cmath>

namespace fogbench::acceptance {
using procedures::Point;
using procedures::PointKind;

namespace {

/// The room's own changes, and a sensor's noise over a minute, stay below this; a gyro that still
/// cools does not.
constexpr double kAtRestCPerH = 0.7;
constexpr double kLeastLengthS = 300.0;
/// Windows of a wait follow one another within a frame or two.
constexpr double kMostGapS = 0.5;
/// The curve begins here; N, B and K are read at seconds and more, and a month of frames is not
/// kept in memory.
constexpr double kIntervalS = 1.0;

bool is_quiet(const Point& point) {
  return point.kind == PointKind::kTransient && !(point.heater_w > 0.0) &&
         std::isnan(point.field_set_ut) &&
         !(std::abs(point.temperature_rate_c_per_h) > kAtRestCPerH);
}

/// Averages of the raw stream over equal intervals; an interval without a frame ends what came
/// before it, and the longest unbroken part counts.
class Averager {
 public:
  Averager(const QuietStretch& stretch, double frame_rate_hz)
      : first_(static_cast<std::int64_t>(std::ceil(stretch.from_s * frame_rate_hz))),
        frames_(std::max<std::int64_t>(std::llround(kIntervalS * frame_rate_hz), 1)),
        intervals_(static_cast<std::int64_t>(stretch.to_s * frame_rate_hz) - first_) {
    intervals_ /= frames_;
  }

  void add(const drivers::GyroBlock& block) {
    for (std::size_t i = 0; i < block.index.size(); ++i) {
      const std::int64_t interval =
          block.index[i] < first_ ? -1 : (block.index[i] - first_) / frames_;
      if (interval < 0 || interval >= intervals_) continue;
      if (interval != open_) close(interval);
      sum_ += static_cast<double>(block.rate_deg_per_h[i]);
      ++count_;
    }
  }

  std::vector<double> longest() {
    close(-1);
    return std::move(longest_);
  }

 private:
  /// Ends the open interval; `next` is the one that begins.
  void close(std::int64_t next) {
    if (count_ > 0) part_.push_back(sum_ / static_cast<double>(count_));
    if (next != open_ + 1) {
      if (part_.size() > longest_.size()) longest_ = part_;
      part_.clear();
    }
    open_ = next;
    sum_ = 0.0;
    count_ = 0;
  }

  std::int64_t first_, frames_, intervals_, open_ = -1;
  double sum_ = 0.0;
  std::size_t count_ = 0;
  std::vector<double> part_, longest_;
};

}  // namespace

std::optional<QuietStretch> quiet_stretch(std::span<const Point> points) {
  std::optional<QuietStretch> longest, open;
  for (const Point& point : points) {
    const double from = point.time_s - 0.5 * point.duration_s;
    const double to = point.time_s + 0.5 * point.duration_s;
    if (!is_quiet(point)) {
      open.reset();
      continue;
    }
    const bool follows = open && open->test == point.test && open->segment == point.segment &&
                         from - open->to_s < kMostGapS;
    if (!follows) open = QuietStretch{point.test, point.segment, from, to};
    open->to_s = to;
    if (!longest || open->to_s - open->from_s > longest->to_s - longest->from_s) longest = open;
  }
  if (longest && longest->to_s - longest->from_s < kLeastLengthS) longest.reset();
  return longest;
}

Result<std::optional<NoiseTerms>> read_noise_terms(record::RunLogReader& reader,
                                                   const record::StoredRun& run,
                                                   const std::optional<QuietStretch>& stretch) {
  std::optional<Averager> averager;
  if (stretch) averager.emplace(*stretch, run.header.frame_rate_hz);
  const Status read = reader.read_gyro(run.run, [&](const drivers::GyroBlock& block) -> Status {
    if (averager) averager->add(block);
    return {};
  });
  if (!read) return read.error();
  if (!averager) return std::optional<NoiseTerms>{};
  const std::vector<double> rate = averager->longest();
  NoiseTerms terms{
      .run = run.run, .stretch = *stretch, .interval_s = kIntervalS, .samples = rate.size()};
  if (static_cast<double>(rate.size()) * kIntervalS < kLeastLengthS) {
    return std::optional<NoiseTerms>{};
  }
  auto curve = model::allan_deviation(rate, kIntervalS);
  if (!curve) return std::optional<NoiseTerms>{};
  terms.curve = std::move(*curve);
  if (auto fit = model::fit_allan(terms.curve)) terms.fit = std::move(*fit);
  return std::optional(std::move(terms));
}

}  // namespace fogbench::acceptance
