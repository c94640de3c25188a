#include "cli/score.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "config/json_file.hpp"
#include "config/place.hpp"
#include "model/effects/catalogue.hpp"

namespace fogbench::cli {
namespace {

/// What a slow effect is called that noise explains as well.
constexpr auto kRandomWalk = "random_walk";

bool holds(const Claim& claim, std::string_view name) {
  return std::find(claim.begin(), claim.end(), name) != claim.end();
}

bool read_name(const config::Place& at, std::string& out) {
  if (!at.present() || !at.value().is_string()) return at.wrong("the name of an effect");
  out = at.value().get<std::string>();
  return true;
}

/// Absent is empty.
bool read_list(const config::Place& at, std::size_t& size) {
  size = 0;
  if (!at.present()) return true;
  if (!at.value().is_array()) return at.wrong("a list");
  size = at.value().size();
  return true;
}

bool read_sets(const config::Place& at, std::vector<Claim>& sets) {
  std::size_t size = 0;
  if (!read_list(at, size)) return false;
  sets.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    const config::Place set = at / i;
    std::size_t names = 0;
    if (!read_list(set, names)) return false;
    sets[i].resize(names);
    for (std::size_t j = 0; j < names; ++j) {
      if (!read_name(set / j, sets[i][j])) return false;
    }
  }
  return true;
}

bool read_missing(const config::Place& at, std::vector<std::string>& names) {
  std::size_t size = 0;
  if (!read_list(at, size)) return false;
  names.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    const config::Place entry = at / i;
    if (!entry.value().is_object()) return entry.wrong("an object with the key \"effect\"");
    if (!read_name(entry / "effect", names[i])) return false;
  }
  return true;
}

bool read(const config::Place& at, Answer& out) {
  if (!at.value().is_object()) return at.wrong("what fogbench diagnose --json printed");
  static const std::vector<std::string> kVerdicts = {"adequate", "missing_effect", "ambiguous",
                                                     "unexplained"};
  const config::Place verdict = at / "verdict";
  if (!verdict.present() ||
      std::none_of(kVerdicts.begin(), kVerdicts.end(),
                   [&](const std::string& name) { return verdict.value() == name; })) {
    return verdict.wrong(fmt::format("one of {}", fmt::join(kVerdicts, ", ")));
  }
  std::vector<std::string> missing;
  std::vector<Claim> sets;
  if (!read_missing(at / "missing", missing) || !read_sets(at / "ambiguous", sets)) return false;
  for (const std::string& name : missing) {
    const auto inside = [&](const Claim& set) { return holds(set, name); };
    if (std::none_of(sets.begin(), sets.end(), inside)) out.claims.push_back({name});
  }
  out.claims.insert(out.claims.end(), sets.begin(), sets.end());
  out.unnamed = verdict.value() == "unexplained";
  return true;
}

}  // namespace

Result<Answer> answer_from(const std::vector<std::string>& effects) {
  Answer answer;
  for (const std::string& effect : effects) {
    if (effect == kNothing) {
      if (effects.size() == 1) return answer;
      return Error{ErrorCode::kBadInput, "--answer: found nothing beside an effect, expected one"};
    }
    if (model::find_effect(effect) == nullptr) {
      return Error{ErrorCode::kBadInput, "--answer: " + model::unknown_effect(effect)};
    }
    if (std::find(answer.claims.begin(), answer.claims.end(), Claim{effect}) !=
        answer.claims.end()) {
      return Error{ErrorCode::kBadInput,
                   fmt::format("--answer: found {} twice, expected it once", effect)};
    }
    answer.claims.push_back({effect});
  }
  return answer;
}

Result<Answer> read_diagnosis(const std::filesystem::path& file) {
  const auto tree = config::read_json_file(file);
  if (!tree) return tree.error();
  config::ReadState state{file, std::nullopt};
  Answer answer;
  if (!read(config::Place(*tree, state), answer)) return *state.error;
  return answer;
}

Score score(const std::vector<std::string>& hidden, const Answer& answer) {
  Score result;
  std::vector<Claim> open = answer.claims;
  // The surest first, so that a set is left for what no claim names alone.
  std::stable_sort(open.begin(), open.end(),
                   [](const Claim& a, const Claim& b) { return a.size() < b.size(); });
  for (const std::string& effect : hidden) {
    const auto claim =
        std::find_if(open.begin(), open.end(), [&](const Claim& c) { return holds(c, effect); });
    const std::size_t names = claim == open.end() ? kMostNames + 1 : claim->size();
    (names == 1            ? result.right
     : names <= kMostNames ? result.in_set
                           : result.missed)
        .push_back(effect);
    if (claim != open.end()) open.erase(claim);
  }
  for (const Claim& claim : open) {
    const bool left_open = holds(claim, kRandomWalk) && claim.size() <= kMostNames;
    if (!left_open) result.invented.push_back(fmt::format("{}", fmt::join(claim, " or ")));
  }
  if (answer.unnamed) result.invented.emplace_back("something without a name");
  return result;
}

}  // namespace fogbench::cli
