#include "model/table/text_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "model/table/table.hpp"

namespace fogbench::model {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string shown(std::string_view text) {
  std::string result = "'";
  for (const char c : text.substr(0, 40)) {
    const auto byte = static_cast<unsigned char>(c);
    result += byte < 0x20 || byte == 0x7f ? fmt::format("\\x{:02x}", byte) : std::string(1, c);
  }
  return result + (text.size() > 40 ? "...'" : "'");
}

bool has_control_characters(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f;
  });
}

bool take_field(std::string_view& line, char separator, std::string& field, bool& last) {
  field.clear();
  const bool blanks = separator == ' ';
  const auto ends = [&](char c) { return c == separator || (blanks && c == '\t'); };
  std::size_t at = 0;
  while (at < line.size() && (line[at] == ' ' || (blanks && line[at] == '\t'))) ++at;
  if (at < line.size() && line[at] == '"') {
    for (++at; at < line.size(); ++at) {
      if (line[at] != '"') {
        field += line[at];
      } else if (at + 1 < line.size() && line[at + 1] == '"') {
        field += line[at++];
      } else {
        break;
      }
    }
    if (at == line.size()) return false;
    ++at;
    while (!blanks && at < line.size() && line[at] == ' ') ++at;
    if (at < line.size() && !ends(line[at])) return false;
  } else {
    const std::size_t begin = at;
    while (at < line.size() && !ends(line[at])) ++at;
    field = trimmed(line.substr(begin, at - begin));
  }
  if (blanks) {
    while (at < line.size() && is_blank(line[at])) ++at;
    last = at == line.size();
    line.remove_prefix(at);
    return true;
  }
  last = at >= line.size();
  line.remove_prefix(last ? line.size() : at + 1);
  return true;
}

bool says_missing(std::string_view text) {
  constexpr std::array<std::string_view, 16> kWords = {
      "-",    "--",  "NA",   "N/A",    "#N/A",   "n/a",     "null",    "NULL",
      "None", "#NV", "#Н/Д", "#ЗНАЧ!", "#WERT!", "#VALUE!", "#DIV/0!", "<NA>"};
  return text.empty() || std::find(kWords.begin(), kWords.end(), text) != kWords.end();
}

std::optional<double> to_number(std::string_view text, bool decimal_comma) {
  if (says_missing(text)) return kMissing;
  std::string with_point;
  if (decimal_comma) {
    // A point would be somebody's separator of thousands.
    if (text.find('.') != std::string_view::npos) return {};
    with_point = text;
    std::replace(with_point.begin(), with_point.end(), ',', '.');
    text = with_point;
  }
  if (text.front() == '+' && !text.substr(1).starts_with('-')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc() || end != text.data() + text.size() || std::isinf(value)) return {};
  return value;
}

}  // namespace fogbench::model
