#pragma once
// Fields of a line of a table of text.

#include <optional>
#include <string>
#include <string_view>

namespace fogbench::model {

/// What was found, short and printable.
std::string shown(std::string_view text);

bool has_control_characters(std::string_view text);

/// Without the blanks around it.
std::string_view trimmed(std::string_view text);

/// Takes the next field off `line`, and its separator (' ': any run of blanks and tabs). Returns
/// false when a quote is never closed. `last` is set when no field follows.
bool take_field(std::string_view& line, char separator, std::string& field, bool& last);

/// The text says that there is no value: nothing, or one of the words for it.
bool says_missing(std::string_view text);

/// A number, NaN for missing, or nothing when the text is neither.
std::optional<double> to_number(std::string_view text, bool decimal_comma = false);

}  // namespace fogbench::model
