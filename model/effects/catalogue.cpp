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
  const std::string_view asked = id.substr(0, 64);
  std::vector<std::string_view> known;
  for (const Effect* effect : catalogue()) known.push_back(effect->info().id);
  const std::string meant = config::did_you_mean(asked, known);
  return fmt::format("unknown effect '{}'{}", asked,
                     meant.empty() ? "; fogbench effects lists them" : meant);
}

}  // namespace fogbench::model
