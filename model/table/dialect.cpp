#include "model/table/dialect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include "model/table/csv_fields.hpp"

namespace fogbench::model {
namespace {

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

std::string_view without_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// The fields as they stand there, quotes kept: what is quoted is not split.
std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  const bool blanks = separator == ' ';
  if (blanks) line = without_blanks(line);
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    const bool ends =
        i == line.size() || (!quoted && (line[i] == separator || (blanks && line[i] == '\t')));
    if (!ends) continue;
    if (!blanks || i > begin) fields.push_back(without_blanks(line.substr(begin, i - begin)));
    begin = i + 1;
  }
  return fields;
}

/// What the commas and points of a field say of it.
enum class Reading { kNothing, kPoint, kComma, kEither, kThousands };

Reading reading_of(std::string_view field) {
  if (!field.empty() && (field.front() == '+' || field.front() == '-')) field.remove_prefix(1);
  const std::size_t exponent = field.find_first_of("eE");
  const std::string_view mantissa = field.substr(0, exponent);
  std::size_t points = 0, commas = 0, digits = 0, after = 0;
  for (const char c : mantissa) {
    points += c == '.' ? 1 : 0;
    commas += c == ',' ? 1 : 0;
    digits += is_digit(c) ? 1 : 0;
    after = c == '.' || c == ',' ? 0 : after + 1;
    if (c != '.' && c != ',' && !is_digit(c)) return Reading::kNothing;  // no number
  }
  if (digits == 0 || points + commas == 0) return Reading::kNothing;
  if ((points > 0 && commas > 0) || points > 1 || commas > 1) return Reading::kThousands;
  if (points == 1) return Reading::kPoint;
  const std::size_t before = digits - after;
  const bool may_be_thousands = after == 3 && before >= 1 && before <= 3 &&
                                mantissa.front() != '0' && exponent == std::string_view::npos;
  return may_be_thousands ? Reading::kEither : Reading::kComma;
}

Error bad(std::string message) {
  return {ErrorCode::kBadInput, std::move(message)};
}

char separator_of(std::string_view names, std::span<const std::string> rows) {
  const bool has_commas = split(names, ',').size() > 1;
  for (const char separator : {';', '\t', '|', ',', ' '}) {
    if (separator == ' ' && has_commas) continue;  // blanks behind commas
    const std::size_t columns = split(names, separator).size();
    const bool splits = columns > 1 && std::all_of(rows.begin(), rows.end(), [&](const auto& row) {
                          return split(row, separator).size() == columns;
                        });
    if (splits) return separator;
  }
  // Something is wrong with a line; the names say what was meant.
  for (const char separator : {',', ';', '\t', '|'}) {
    if (split(names, separator).size() > 1) return separator;
  }
  return ',';
}

}  // namespace

std::string Dialect::says() const {
  constexpr std::array<std::pair<char, std::string_view>, 5> kNames = {
      {{',', "commas"}, {';', "semicolons"}, {'\t', "tabs"}, {'|', "bars"}, {' ', "blanks"}}};
  for (const auto& [which, name] : kNames) {
    if (which != separator) continue;
    return fmt::format("separated by {}{}", name, decimal_comma ? ", with decimal commas" : "");
  }
  return {};
}

std::string Dialect::plain_line(std::string_view line) const {
  std::string out;
  bool first = true;
  for (const std::string_view field : split(line, separator)) {
    if (!first) out += ',';
    first = false;
    if (decimal_comma && reading_of(field) != Reading::kNothing) {
      std::string number(field);
      std::replace(number.begin(), number.end(), ',', '.');
      out += number;
    } else if (field.find(',') != std::string_view::npos && !field.starts_with('"')) {
      out += fmt::format("\"{}\"", field);
    } else {
      out += field;
    }
  }
  return out;
}

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
}

Result<Dialect> recognise(std::string_view names, std::span<const std::string> rows) {
  Dialect dialect{.separator = separator_of(names, rows)};
  if (dialect.separator == ',') return dialect;
  std::string_view comma, point, either;
  for (const std::string& row : rows) {
    for (const std::string_view field : split(row, dialect.separator)) {
      switch (reading_of(field)) {
        case Reading::kThousands:
          return bad(fmt::format("found {}, expected numbers without separators of thousands",
                                 shown(field)));
        case Reading::kComma:
          comma = field;
          break;
        case Reading::kPoint:
          point = field;
          break;
        case Reading::kEither:
          either = field;
          break;
        case Reading::kNothing:
          break;
      }
    }
  }
  if (!comma.empty() && !point.empty()) {
    return bad(fmt::format("found {} and {}, expected decimal commas or decimal points, not both",
                           shown(comma), shown(point)));
  }
  if (!either.empty() && comma.empty()) {
    std::string with_point(either), without(either);
    std::replace(with_point.begin(), with_point.end(), ',', '.');
    std::erase(without, ',');
    return bad(
        fmt::format("found {}: {} or {}? Expected decimal points, or a number with other "
                    "than three decimals among the first rows",
                    shown(either), with_point, without));
  }
  dialect.decimal_comma = !comma.empty();
  return dialect;
}

}  // namespace fogbench::model
