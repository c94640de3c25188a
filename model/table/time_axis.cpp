#include "model/table/time_axis.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "model/table/median.hpp"

namespace fogbench::model {
namespace {

constexpr double kDay = 86400.0;
/// A wrap's step is at most so many usual ones.
constexpr double kMostSteps = 20.0;
/// Steps that are looked at for the usual one.
constexpr std::size_t kStepsLookedAt = 4096;

double usual_step(std::span<const double> values) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size() && steps.size() < kStepsLookedAt; ++i) {
    if (values[i] > values[i - 1]) steps.push_back(values[i] - values[i - 1]);
  }
  return median(std::move(steps));
}

/// Goes on where the values fall by nearly `period`; how often they did.
std::size_t go_on(double period, std::span<const std::uint32_t> run, std::vector<double>& values) {
  const double most = kMostSteps * usual_step(values);
  if (!(most < period / 2)) return 0;
  std::size_t wraps = 0;
  double added = 0.0, before = kMissing;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    if (i > 0 && !run.empty() && run[i] != run[i - 1]) {
      added = 0.0;
      before = kMissing;
    }
    const double stated = values[i];
    const double step = stated + period - before;
    if (stated < before && before <= period && step > 0.0 && step <= most) {
      added += period;
      ++wraps;
    }
    before = stated;
    values[i] = stated + added;
  }
  return wraps;
}

bool are_whole(std::span<const double> values) {
  for (const double value : values) {
    if (!std::isnan(value) && (value != std::floor(value) || value < 0.0)) return false;
  }
  return true;
}

std::string times(std::size_t count) {
  return count == 1 ? "once" : fmt::format("{} times", count);
}

}  // namespace

std::optional<double> TextStamps::take(std::string_view text, SlashDate order) {
  const auto stamp = time_stamp(text, order);
  if (!stamp || (stamp->slashes && order == SlashDate::kUnknown)) return {};
  ++(stamp->has_date ? dates_ : times_);
  zones_ += stamp->has_zone ? 1 : 0;
  return stamp->seconds;
}

Result<std::vector<std::string>> TextStamps::settle(std::vector<double>& seconds) const {
  if (dates_ > 0 && times_ > 0) {
    return Error{ErrorCode::kBadInput,
                 "found stamps with and without a date in one column, expected one kind"};
  }
  if (times_ > 0) {
    const std::size_t midnights = go_on(kDay, {}, seconds);
    return std::vector<std::string>{
        midnights > 0 ? fmt::format("times of day, midnight passed {}", times(midnights))
                      : "times of day"};
  }
  if (zones_ > 0 && zones_ < dates_) {
    return Error{ErrorCode::kBadInput,
                 "found stamps with and without a time zone in one column, expected one kind"};
  }
  return std::vector<std::string>{zones_ > 0 ? "dates with their time zone"
                                             : "dates without a time zone, taken as UTC"};
}

Result<std::vector<std::string>> settle_counter(const ChosenColumn& chosen,
                                                std::span<const std::uint32_t> run,
                                                std::vector<double>& values) {
  std::vector<std::string> says;
  constexpr std::array<int, 2> kCounterBits = {16, 32};
  for (const int bits : kCounterBits) {
    if (!are_whole(values)) break;
    const std::size_t wraps = go_on(std::ldexp(1.0, bits), run, values);
    if (wraps == 0) continue;
    says.push_back(fmt::format("the counter of {} bits wrapped {}", bits, times(wraps)));
    break;
  }
  if (chosen.unit != nullptr || !chosen.is_foreign) {
    convert(chosen, values);
    return says;
  }
  // 2001-09-09 and 2100-01-01.
  constexpr double kEarliest = 1e9, kLatest = 4102444800.0;
  struct Part {
    double of_second;
    const char* name;
  };
  constexpr std::array<Part, 4> kParts = {{{1.0, "s"}, {1e-3, "ms"}, {1e-6, "us"}, {1e-9, "ns"}}};
  double first = kMissing;
  for (std::size_t i = 0; i < values.size() && std::isnan(first); ++i) first = values[i];
  for (const Part& part : kParts) {
    const double seconds = first * part.of_second;
    if (!(seconds >= kEarliest && seconds < kLatest)) continue;
    for (double& value : values) value *= part.of_second;
    says.push_back(fmt::format("Unix stamps in {}", part.name));
    return says;
  }
  says.emplace_back("time_s, whose unit is not stated, as s");
  return says;
}

}  // namespace fogbench::model
