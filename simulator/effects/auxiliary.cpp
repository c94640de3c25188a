// Effects of what only an auxiliary sensor of the bench sees: the room's pressure, a supply
// voltage.

#include "simulator/effects/effect.hpp"

namespace fogbench::simulator {

std::optional<std::string> sensitive_to(std::string_view id) {
  constexpr std::string_view kBefore = "sensitivity(";
  if (!id.starts_with(kBefore) || !id.ends_with(')')) return std::nullopt;
  return std::string(id.substr(kBefore.size(), id.size() - kBefore.size() - 1));
}

Regressor sensitivity_to(std::string channel) {
  return [channel = std::move(channel)](const TrueState& s) {
    const auto found = s.auxiliary.find(channel);
    return found == s.auxiliary.end() ? 0.0 : found->second;
  };
}

}  // namespace fogbench::simulator
