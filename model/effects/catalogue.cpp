#include "model/effects/catalogue.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <deque>
#include <utility>

#include "config/nearest_name.hpp"
#include "model/effects/families.hpp"
#include "model/effects/loop.hpp"
#include "model/effects/sensitivity.hpp"

namespace fogbench::model {
namespace {

/// By part of the documentation, within it in the order of the files and of their effects.
std::vector<const Effect*> make_catalogue() {
  static std::deque<effects::FunctionEffect> made;
  std::vector<const Effect*> all;
  for (const auto family : effects::kFamilies) {
    for (effects::FunctionParts& parts : family()) {
      all.push_back(&made.emplace_back(std::move(parts)));
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Effect* a, const Effect* b) {
    return a->info().group < b->info().group;
  });
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

bool is_field_sensitivity(std::string_view id) {
  const Effect* effect = find_effect(id);
  return effect != nullptr && effect->info().field_sensitivity;
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
