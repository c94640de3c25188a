#pragma once
// What was probably meant by a name that is not known.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fogbench::config {

/// Levenshtein's distance: insertions, deletions and replacements from one name to the other.
std::size_t edits_between(std::string_view a, std::string_view b);

/// The known name that is most like `name`, empty when none is near (two edits, or a third of its
/// letters).
std::string_view nearest_name(std::string_view name, const std::vector<std::string_view>& known);

/// The known names of which `name` is a part, such as a family's: all of them, up to eight.
std::vector<std::string_view> names_with(std::string_view name,
                                         const std::vector<std::string_view>& known);

/// What ends the sentence about an unknown name: `; did you mean "NAME"?`, `; did you mean one of
/// "NAME", "NAME"?`, or nothing.
std::string did_you_mean(std::string_view name, const std::vector<std::string_view>& known);

}  // namespace fogbench::config
