#include "config/nearest_name.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <numeric>

namespace fogbench::config {
namespace {

/// Fewer letters are a part of too many names, and more names are no answer.
constexpr std::size_t kLeastPart = 3, kMostNames = 8;

}  // namespace

std::size_t edits_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

std::string_view nearest_name(std::string_view name, const std::vector<std::string_view>& known) {
  if (name.size() > 64) return {};
  std::string_view nearest;
  std::size_t fewest = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const std::string_view candidate : known) {
    const std::size_t edits = edits_between(name, candidate);
    if (edits < fewest) {
      fewest = edits;
      nearest = candidate;
    }
  }
  return nearest;
}

std::vector<std::string_view> names_with(std::string_view name,
                                         const std::vector<std::string_view>& known) {
  std::vector<std::string_view> with;
  if (name.size() < kLeastPart) return with;
  std::copy_if(known.begin(), known.end(), std::back_inserter(with),
               [name](std::string_view one) { return one.find(name) != one.npos; });
  if (with.size() > kMostNames) with.clear();
  return with;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string_view>& known) {
  std::vector<std::string_view> meant;
  if (const std::string_view near = nearest_name(name, known); !near.empty()) {
    meant.push_back(near);
  } else {
    meant = names_with(name, known);
  }
  if (meant.empty()) return "";
  return fmt::format("; did you mean {}\"{}\"?", meant.size() > 1 ? "one of " : "",
                     fmt::join(meant, "\", \""));
}

}  // namespace fogbench::config
