// The list of all effects, in the order of the documentation. A new effect is one file in
// model/effects/ and one line here.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "config/nearest_name.hpp"
#include "model/effects/list.hpp"
#include "model/effects/loop.hpp"
#include "model/effects/sensitivity.hpp"

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

}  // namespace

std::span<const Effect* const> catalogue() {
  static const std::vector<const Effect*> all = make_catalogue();
  return all;
}

const Effect* find_effect(std::string_view id) {
  const auto all = catalogue();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Effect* e) { return e->info().id == id; });
  if (found != all.end()) return *found;
  const Effect* loop = effects::find_loop(id);
  return loop != nullptr ? loop : effects::find_sensitivity(id);
}

std::string unknown_effect(std::string_view id) {
  const std::string_view asked = id.substr(0, 80);
  std::vector<std::pair<std::size_t, std::string_view>> nearest;
  for (const Effect* effect : catalogue()) {
    nearest.emplace_back(config::edits_between(asked, effect->info().id), effect->info().id);
  }
  std::stable_sort(nearest.begin(), nearest.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  return fmt::format("unknown effect '{}', the nearest are {}, {} and {}", asked, nearest[0].second,
                     nearest[1].second, nearest[2].second);
}

}  // namespace fogbench::model
