#include "simulator/effects/effect.hpp"

#include <algorithm>

#include "simulator/effects/families.hpp"

namespace fogbench::simulator {

const std::vector<EffectEntry>& all_effects() {
  static const std::vector<EffectEntry> entries = [] {
    std::vector<EffectEntry> all;
    for (const auto family : effects::kFamilies) {
      for (EffectEntry& entry : family()) all.push_back(std::move(entry));
    }
    return all;
  }();
  return entries;
}

std::optional<NamedEffect> find_effect(std::string_view name) {
  const std::size_t open = name.find('(');
  const bool bracketed = open != std::string_view::npos && name.ends_with(')');
  const std::string_view id = bracketed ? name.substr(0, open) : name;
  const auto& all = all_effects();
  const auto found = std::find_if(all.begin(), all.end(), [&](const EffectEntry& entry) {
    return entry.id == id && entry.of_a_channel == bracketed;
  });
  if (found == all.end()) return std::nullopt;
  if (!bracketed) return NamedEffect{&*found, found->channel};
  return NamedEffect{&*found, std::string(name.substr(open + 1, name.size() - open - 2))};
}

}  // namespace fogbench::simulator
