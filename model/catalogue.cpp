// The list of all effects, in the order of the documentation. A new effect is one file in
// model/effects/ and one line here.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "model/effects/list.hpp"

namespace fogbench::model {
namespace {

std::vector<const Effect*> make_catalogue() {
  using namespace effects;
  std::vector<const Effect*> all;
  const auto add = [&](const FunctionEffect& effect) { all.push_back(&effect); };
  const auto add_family = [&](const Family& family) {
    for (const FunctionEffect& effect : family) all.push_back(&effect);
  };
  add(bias());
  add(bias_step());
  add(drift_linear());
  add(warm_up());
  add_family(temperature_polynomial());
  add(temperature_rate());
  add(temperature_rate_lagged());
  add(temperature_acceleration());
  add(temperature_rate_cross());
  add(temperature_gradient());
  add(temperature_hysteresis());
  add(temperature_ripple());
  add(heater_power());
  add(ambient_temperature());
  add_family(magnetic_linear());
  add_family(magnetic_quadratic());
  add_family(magnetic_cross());
  add_family(magnetic_saturation());
  add_family(magnetic_hysteresis());
  add_family(magnetic_settling());
  add_family(magnetic_temperature());
  add(coil_heating());
  add(earth_rate_projection());
  return all;
}

/// Levenshtein's distance: insertions, deletions and replacements.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, replaced}));
    }
  }
  return row.back();
}

}  // namespace

std::span<const Effect* const> catalogue() {
  static const std::vector<const Effect*> all = make_catalogue();
  return all;
}

const Effect* find_effect(std::string_view id) {
  const auto all = catalogue();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Effect* e) { return e->info().id == id; });
  return found == all.end() ? nullptr : *found;
}

std::string unknown_effect(std::string_view id) {
  const std::string_view asked = id.substr(0, 80);
  std::vector<std::pair<std::size_t, std::string_view>> nearest;
  for (const Effect* effect : catalogue()) {
    nearest.emplace_back(distance(asked, effect->info().id), effect->info().id);
  }
  std::stable_sort(nearest.begin(), nearest.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  return fmt::format("unknown effect '{}', the nearest are {}, {} and {}", asked, nearest[0].second,
                     nearest[1].second, nearest[2].second);
}

}  // namespace fogbench::model
