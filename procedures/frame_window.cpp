#include "procedures/frame_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fogbench::procedures {
namespace {

/// Four chains of additions at once: one would wait for each addition before the next.
constexpr std::size_t kLanes = 4;

template <class Term>
double sum_of(std::span<const float> samples, const Term& term) {
  std::array<double, kLanes> sums{};
  std::size_t i = 0;
  for (; i + kLanes <= samples.size(); i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      sums[lane] += term(static_cast<double>(samples[i + lane]));
    }
  }
  for (; i < samples.size(); ++i) sums[0] += term(static_cast<double>(samples[i]));
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

}  // namespace

void FrameWindow::add(const drivers::GyroBlock& block) {
  if (complete_ || block.index.empty()) return;
  const auto first = std::lower_bound(block.index.begin(), block.index.end(), begin_);
  const auto stop = std::lower_bound(first, block.index.end(), end_);
  if (first != stop) {
    const bool unbroken = *(stop - 1) - *first == (stop - first) - 1;
    if (unbroken) {
      note_loss(*first);
    } else {
      for (auto index = first; index != stop; ++index) {
        note_loss(*index);
        last_ = *index;
      }
    }
    last_ = *(stop - 1);
    add_samples(std::span(block.rate_deg_per_h)
                    .subspan(static_cast<std::size_t>(first - block.index.begin()),
                             static_cast<std::size_t>(stop - first)));
  }
  if (block.index.back() >= end_ - 1) {
    note_loss(end_);
    complete_ = true;
  }
}

void FrameWindow::note_loss(std::int64_t next) {
  worst_loss_ = std::max(worst_loss_, next - last_ - 1);
}

/// Mean and squares of the block, then merged with those so far (Chan, Golub, LeVeque 1979).
void FrameWindow::add_samples(std::span<const float> samples) {
  const auto n = static_cast<double>(samples.size());
  const double mean = sum_of(samples, [](double x) { return x; }) / n;
  const double squares = sum_of(samples, [mean](double x) { return (x - mean) * (x - mean); });
  const auto before = static_cast<double>(count_);
  const double difference = mean - mean_;
  mean_ += difference * n / (before + n);
  squares_ += squares + difference * difference * before * n / (before + n);
  count_ += samples.size();
}

double FrameWindow::mean() const {
  return count_ == 0 ? std::numeric_limits<double>::quiet_NaN() : mean_;
}

double FrameWindow::standard_deviation() const {
  if (count_ < 2) return std::numeric_limits<double>::quiet_NaN();
  return std::sqrt(squares_ / static_cast<double>(count_ - 1));
}

}  // namespace fogbench::procedures
