#pragma once
// An averaging window over the gyro's frames, by their counter and never by the clock: the frames
// begin ... begin + length - 1. Lost ones are counted; too many lost in a row are a gap, which
// voids the window.

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/instruments.hpp"

namespace fogbench::procedures {

class FrameWindow {
 public:
  /// `longest_loss`: how many consecutive lost frames the window survives.
  FrameWindow(std::int64_t begin, std::int64_t length, std::int64_t longest_loss)
      : begin_(begin), end_(begin + length), longest_loss_(longest_loss), last_(begin - 1) {}

  /// Takes the frames of the block that lie in the window. Indexes rise within a block and from
  /// block to block.
  void add(const drivers::GyroBlock& block);

  std::int64_t begin() const { return begin_; }
  std::int64_t end() const { return end_; }  ///< index after the last frame
  /// The last frame, or one after it, has come.
  bool complete() const { return complete_; }
  bool has_gap() const { return worst_loss_ > longest_loss_; }
  std::int64_t worst_loss() const { return worst_loss_; }  ///< most frames lost in a row
  std::uint64_t count() const { return count_; }
  /// Precondition: complete().
  std::uint64_t dropped() const { return static_cast<std::uint64_t>(end_ - begin_) - count_; }
  /// NaN without frames.
  double mean() const;
  /// Of the samples, with n - 1; NaN for fewer than two.
  double standard_deviation() const;

 private:
  void add_samples(std::span<const float> samples);
  void note_loss(std::int64_t next);

  std::int64_t begin_, end_, longest_loss_;
  std::int64_t last_;  ///< newest good frame of the window
  std::int64_t worst_loss_ = 0;
  bool complete_ = false;
  std::uint64_t count_ = 0;
  double mean_ = 0.0;
  double squares_ = 0.0;  ///< sum of (sample - mean)^2
};

}  // namespace fogbench::procedures
