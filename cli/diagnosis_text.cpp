#include "cli/diagnosis_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "cli/output.hpp"
#include "config/rounding.hpp"

namespace fogbench::cli {
namespace {

/// "first, second" under each of the headings, in the order in which they first come.
class GroupedLines {
 public:
  void add(const std::string& heading, const std::string& item) {
    const auto found = std::find_if(lines_.begin(), lines_.end(),
                                    [&](const auto& line) { return line.first == heading; });
    if (found == lines_.end()) {
      lines_.emplace_back(heading, item);
    } else {
      found->second += ", " + item;
    }
  }
  void print(const std::string& title) const {
    if (!lines_.empty()) fmt::print("{}\n", title);
    for (const auto& [heading, items] : lines_) fmt::print("  {}: {}\n", heading, items);
  }

 private:
  std::vector<std::pair<std::string, std::string>> lines_;
};

void print_bounds(const std::vector<model::Bound>& bounds) {
  GroupedLines lines;
  for (const model::Bound& b : bounds) {
    lines.add(b.unit, b.effect + " " + config::significant(b.absent_or_below, 2));
  }
  lines.print("Absent, or smaller than this (95 %):");
}

void print_not_testable(const std::vector<model::NotTestable>& effects) {
  GroupedLines lines;
  for (const model::NotTestable& n : effects) lines.add(n.because, n.effect);
  lines.print("What these data cannot test:");
}

std::string few_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 4;
  const std::size_t shown = names.size() > kMost + 1 ? kMost : names.size();
  const std::vector<std::string> first(names.begin(),
                                       names.begin() + static_cast<std::ptrdiff_t>(shown));
  const std::string rest =
      shown < names.size() ? fmt::format(" and {} more", names.size() - shown) : std::string();
  return fmt::format("{}{}", fmt::join(first, ", "), rest);
}

void print_ladder(const model::Diagnosis& d, const std::string& in) {
  const auto number = [](double value) { return config::significant(value, 3); };
  TextTable ladder({{"model", "", TextTable::Align::kLeft},
                    {"RMS", in},
                    {"held-out RMS", in},
                    {"noise floor", in}});
  for (const model::LadderStep& step : d.ladder) {
    ladder.add_row({step.added.empty() ? "as it came" : "+ " + step.added, number(step.rms),
                    number(step.heldout_rms), number(d.noise_floor)});
  }
  fmt::print("{}", ladder.text());
  if (std::isfinite(d.floor.white)) {
    fmt::print("The noise floor: {}.\n", d.floor.parts_in_words(in));
  }
}

void print_failures(const model::Diagnosis& d) {
  constexpr std::size_t kMostFailures = 3;
  std::size_t shown = 0;
  for (const model::Region& r : d.before.regions) {
    if (!d.before.noise_known || r.p_family_wise > d.false_alarm_rate) continue;
    if (shown++ == 0) fmt::print("\nWhere the model as it came fails most:\n");
    fmt::print("  {}\n", r.says);
    if (shown == kMostFailures) break;
  }
}

/// What tells apart is named with the effects; what shows effects never seen names them itself.
void print_next(const model::Diagnosis& d, bool tells_apart, const std::string& title) {
  bool first = true;
  for (const model::NextMeasurement& n : d.next_measurements) {
    const bool tells = n.purpose != model::NextMeasurement::Purpose::kShow;
    if (tells != tells_apart || &n == model::proposed_measurement(d)) continue;
    if (first) fmt::print("\n{}\n", title);
    first = false;
    fmt::print("  {}{}\n", n.action,
               tells_apart ? fmt::format(" (for {})", few_of(n.tells_apart)) : std::string());
  }
}

}  // namespace

void print_diagnosis(const model::Diagnosis& d, const model::VerdictWords& words,
                     std::string_view unit) {
  fmt::print("{}\n{}\n{}\n\n", words.verdict, words.evidence, words.to_do);
  print_ladder(d, std::string(unit));
  const bool details = !words.details.empty() || !d.notes.empty() || !d.after.warnings.empty();
  if (details) fmt::print("\n");
  for (const std::string& sentence : words.details) fmt::print("{}\n", sentence);
  for (const std::string& note : d.notes) fmt::print("note: {}\n", note);
  for (const std::string& warning : d.after.warnings) fmt::print("warning: {}\n", warning);
  print_failures(d);
  print_next(
      d, true,
      model::proposed_measurement(d) ? "What tells them apart, too:" : "What tells them apart:");
  fmt::print("\n");
  print_bounds(d.bounds);
  if (!d.bounds.empty() && !d.not_testable.empty()) fmt::print("\n");
  print_not_testable(d.not_testable);
  print_next(d, false, "What would show what these data cannot:");
}

}  // namespace fogbench::cli
