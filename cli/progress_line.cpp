#include "cli/progress_line.hpp"

#include <fmt/format.h>

#include "cli/output.hpp"
#include "procedures/sentence.hpp"

namespace fogbench::cli {

ProgressLine::ProgressLine() : wanted_(progress_wanted()) {}

void ProgressLine::show(const procedures::Progress& progress) {
  constexpr std::chrono::milliseconds kPeriod{200};
  constexpr std::size_t kWidth = 79;
  if (!wanted_ || clock_.now() < next_) return;
  next_ = clock_.now() + kPeriod;
  std::string line =
      fmt::format("[{}/{}] {} left  {}", std::min(progress.step + 1, progress.steps),
                  progress.steps, procedures::duration_text(progress.remaining), progress.says);
  if (line.size() > kWidth) line.resize(kWidth);
  fmt::print(stderr, "\r{:<{}}", line, kWidth);
  std::fflush(stderr);
  shown_ = true;
}

void ProgressLine::clear() {
  if (!shown_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  shown_ = false;
}

}  // namespace fogbench::cli
