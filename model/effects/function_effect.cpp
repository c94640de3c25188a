#include "model/effects/function_effect.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>

namespace fogbench::model::effects {

std::function<std::string(const Signals&)> Axis::needs_three_levels() const {
  return [name = signal](const Signals& signals) -> std::string {
    constexpr double kLevelUt = 10.0;
    std::set<long> levels;
    for (const double ut : signals.signal(name)) {
      if (std::isfinite(ut)) levels.insert(std::lround(ut / kLevelUt));
    }
    return levels.size() < 3 ? fmt::format("{} takes fewer than three levels", name) : "";
  };
}

Family along_each_axis(std::string_view family, FunctionParts (*make)(const Axis&)) {
  Family out;
  for (const char* letter : {"x", "y", "z"}) {
    const Axis axis{letter};
    FunctionParts& made = out.emplace_back(make(axis));
    made.info.id = axis.of(family);
    made.info.family = family;
  }
  return out;
}

}  // namespace fogbench::model::effects
