#include "model/compare/loops.hpp"

#include <algorithm>
#include <cmath>

namespace fogbench::model {
namespace {

// As shares of the variable's whole range: a stop holds values this close; a pass has turned when
// it has come back this far; a pass shorter than the last is left out.
constexpr double kStop = 1.0 / 40.0;
constexpr double kTurn = 0.15;
constexpr double kPass = 0.45;
constexpr std::size_t kFewestStops = 3;
// Share of the rows that passes must hold: noise turns all the time and seldom goes far.
constexpr double kCovered = 0.75;

struct Step {
  std::size_t row;  ///< of the table
  double value;
};

/// The steps of one pass, `from` to `to`, gathered into stops.
Branch make_branch(const std::vector<Step>& steps, std::size_t from, std::size_t to, double range) {
  Branch out{.rising = steps[to].value >= steps[from].value};
  double stands_at = 0.0;
  for (std::size_t i = from; i <= to; ++i) {
    if (out.stops.empty() || std::abs(steps[i].value - stands_at) > kStop * range) {
      out.stops.emplace_back();
      stands_at = steps[i].value;
    }
    out.stops.back().push_back(steps[i].row);
  }
  return out;
}

/// Where the values turn round: the first step, each turning point, the last step.
std::vector<std::size_t> turns_of(const std::vector<Step>& steps, double range) {
  std::vector<std::size_t> turns{0};
  std::size_t lowest = 0, highest = 0;
  int direction = 0;  // not known yet
  for (std::size_t i = 1; i < steps.size(); ++i) {
    if (steps[i].value > steps[highest].value) highest = i;
    if (steps[i].value < steps[lowest].value) lowest = i;
    if (direction >= 0 && steps[highest].value - steps[i].value > kTurn * range) {
      if (highest > turns.back()) turns.push_back(highest);
      direction = -1;
      lowest = highest = i;
    } else if (direction <= 0 && steps[i].value - steps[lowest].value > kTurn * range) {
      if (lowest > turns.back()) turns.push_back(lowest);
      direction = 1;
      lowest = highest = i;
    }
  }
  if (turns.back() + 1 < steps.size()) turns.push_back(steps.size() - 1);
  return turns;
}

/// The passes of one run or sweep; none where the variable is noise or mostly stands still.
void add_branches(std::vector<Branch>& out, const std::vector<Step>& steps, double range) {
  if (steps.size() < 2 * kFewestStops) return;
  const std::vector<std::size_t> turns = turns_of(steps, range);
  std::vector<Branch> found;
  std::size_t covered = 0;
  bool last_was_kept = false;
  for (std::size_t k = 0; k + 1 < turns.size(); ++k) {
    Branch branch = make_branch(steps, turns[k], turns[k + 1], range);
    const double span = std::abs(steps[turns[k + 1]].value - steps[turns[k]].value);
    const bool kept = branch.stops.size() >= kFewestStops && span >= kPass * range;
    if (kept) {
      branch.continues = last_was_kept;
      covered += turns[k + 1] - turns[k];
      found.push_back(std::move(branch));
    }
    last_was_kept = kept;
  }
  if (static_cast<double>(covered) < kCovered * static_cast<double>(steps.size())) return;
  std::move(found.begin(), found.end(), std::back_inserter(out));
}

}  // namespace

std::vector<Branch> branches_of(const Signals& signals, std::string_view variable) {
  const Signals::View values = signals.signal(variable);
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(low < high)) return {};
  const bool by_sweep = variable.starts_with("field_");
  const TextColumn& segment = signals.table().segment();
  const auto sweep_of = [&](std::size_t row) {
    const std::string_view text = segment.at(row);
    return by_sweep ? text.substr(0, text.find('/')) : std::string_view{};
  };
  std::vector<Branch> out;
  for (const Signals::RunRange& run : signals.runs()) {
    std::vector<Step> steps;
    std::string_view sweep;
    for (std::size_t i = run.begin; i < run.end; ++i) {
      const double value = values[static_cast<Eigen::Index>(i)];
      if (!std::isfinite(value)) continue;
      const std::size_t row = signals.table_row(i);
      if (sweep_of(row) != sweep) {
        add_branches(out, steps, high - low);
        steps.clear();
        sweep = sweep_of(row);
      }
      steps.push_back({row, value});
    }
    add_branches(out, steps, high - low);
  }
  const auto rises = [](const Branch& branch) { return branch.rising; };
  const auto rising = std::count_if(out.begin(), out.end(), rises);
  if (rising == 0 || rising == static_cast<std::ptrdiff_t>(out.size())) return {};
  return out;
}

}  // namespace fogbench::model
