#include "model/table/csv_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "model/table/table.hpp"

namespace fogbench::model {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

}  // namespace

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

bool take_field(std::string_view& line, std::string& field, bool& last) {
  field.clear();
  std::size_t at = 0;
  while (at < line.size() && line[at] == ' ') ++at;
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
    while (at < line.size() && line[at] == ' ') ++at;
    if (at < line.size() && line[at] != ',') return false;
  } else {
    at = std::min(line.find(','), line.size());
    field = trimmed(line.substr(0, at));
  }
  last = at >= line.size();
  line.remove_prefix(last ? line.size() : at + 1);
  return true;
}

std::optional<double> to_number(std::string_view text) {
  constexpr std::array<std::string_view, 6> kMissingWords = {"-",    "NA",  "N/A",
                                                             "#N/A", "n/a", "null"};
  if (text.empty() ||
      std::find(kMissingWords.begin(), kMissingWords.end(), text) != kMissingWords.end()) {
    return kMissing;
  }
  if (text.front() == '+' && !text.substr(1).starts_with('-')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc() || end != text.data() + text.size() || std::isinf(value)) return {};
  return value;
}

}  // namespace fogbench::model
