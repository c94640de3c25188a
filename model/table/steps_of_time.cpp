#include "model/table/steps_of_time.hpp"

#include <algorithm>
#include <cmath>

#include "model/table/median.hpp"

namespace fogbench::model {
namespace {

constexpr std::size_t kStepsForMedian = 100'000;
constexpr std::size_t kMostGapsKept = 10;
constexpr double kGapSteps = 3.0;
/// Of what a run has covered.
constexpr double kRestartShare = 0.5;
constexpr std::size_t kMostRestarts = 10;

}  // namespace

StepsOfTime steps_of_time(const Table& table) {
  StepsOfTime out;
  const auto time = table.column("time_s");
  const auto& run = table.run().index;
  std::vector<double> steps;
  const std::size_t every = time.size() / kStepsForMedian + 1;
  for (std::size_t row = 1; row < time.size(); ++row) {
    const double step = time[row] - time[row - 1];
    if (row % every == 0 && step > 0.0 && run[row] == run[row - 1]) steps.push_back(step);
  }
  out.usual_s = median(std::move(steps));
  double before = kMissing, first = kMissing;
  for (std::size_t row = 0; row < time.size(); ++row) {
    if (row > 0 && run[row] != run[row - 1]) before = first = kMissing;
    if (std::isnan(time[row])) {
      ++out.blank;
      continue;
    }
    if (std::isnan(first)) first = time[row];
    const double step = time[row] - before;
    if (step < 0.0) {
      if (out.backwards++ == 0) out.first_backwards = row;
      // Not a single row: it goes on from there.
      const bool goes_on =
          row + 1 < time.size() && time[row + 1] > time[row] && time[row + 1] < before;
      const bool far =
          before - first > 2.0 * out.usual_s && -step > kRestartShare * (before - first);
      if (far && goes_on) {
        if (out.restarts.size() < kMostRestarts) out.restarts.push_back({row, before, time[row]});
        first = time[row];
      }
    } else if (step == 0.0) {
      if (out.repeated++ == 0) out.first_repeated = row;
    } else if (step > kGapSteps * out.usual_s) {
      ++out.gap_count;
      out.gaps.push_back({row, before, time[row]});
      if (out.gaps.size() > kMostGapsKept) {
        std::nth_element(out.gaps.begin(), out.gaps.begin() + kMostGapsKept, out.gaps.end(),
                         [](const TimeFall& a, const TimeFall& b) {
                           return a.to_s - a.from_s > b.to_s - b.from_s;
                         });
        out.gaps.pop_back();
      }
    }
    before = time[row];
  }
  std::sort(out.gaps.begin(), out.gaps.end(), [](const TimeFall& a, const TimeFall& b) {
    return a.to_s - a.from_s > b.to_s - b.from_s;
  });
  return out;
}

}  // namespace fogbench::model
