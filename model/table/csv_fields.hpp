#pragma once
// Fields of a line of comma-separated values.

#include <optional>
#include <string>
#include <string_view>

namespace fogbench::model {

/// What was found, short and printable.
std::string shown(std::string_view text);

bool has_control_characters(std::string_view text);

/// Takes the next field off `line`, and its comma. Returns false when a quote is never closed.
/// `last` is set when no field follows.
bool take_field(std::string_view& line, std::string& field, bool& last);

/// A number, NaN for missing, or nothing when the text is neither.
std::optional<double> to_number(std::string_view text);

}  // namespace fogbench::model
