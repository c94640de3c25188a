#include "model/table/dialect.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

#include "config/column_unit.hpp"
#include "model/table/text_fields.hpp"

namespace fogbench::model {
namespace {

/// So many lines are looked at, of those in the first 64 KiB.
constexpr std::size_t kLinesLookedAt = 1000;

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

Error unclear(std::string message) {
  return {ErrorCode::kBadInput, std::move(message)};
}

/// The fields of a line and which of them stood in quotes.
struct Fields {
  std::vector<std::string> text;
  std::vector<bool> quoted;
  std::size_t count() const { return text.size(); }
};

Fields split(std::string_view line, char separator) {
  Fields fields;
  if (separator == ' ') line = trimmed(line);
  std::string field;
  for (bool last = false; !last;) {
    const std::size_t first = line.find_first_not_of(' ');
    const bool quoted = first != std::string_view::npos && line[first] == '"';
    if (!take_field(line, separator, field, last)) {  // a quote that is never closed
      fields.text.emplace_back(line);
      fields.quoted.push_back(false);
      break;
    }
    fields.text.push_back(field);
    fields.quoted.push_back(quoted);
  }
  return fields;
}

/// Of names between blanks a bracket belongs to the name before it: "rate [deg/s]".
Fields with_brackets(Fields fields) {
  Fields out;
  for (std::size_t i = 0; i < fields.count(); ++i) {
    const char first = fields.text[i].empty() ? '\0' : fields.text[i].front();
    if ((first == '[' || first == '(') && out.count() > 0 && !fields.quoted[i]) {
      out.text.back() += " " + fields.text[i];
    } else {
      out.text.push_back(std::move(fields.text[i]));
      out.quoted.push_back(fields.quoted[i]);
    }
  }
  return out;
}

constexpr std::array<std::string_view, 4> kGroupMarks = {"\u00A0", "\u202F", "'", " "};

/// Groups of three digits with the same mark between them, "1 234 567", perhaps with decimals
/// behind `decimal`.
bool is_grouped(std::string_view digits, std::string_view mark, char decimal) {
  std::size_t groups = 0, run = 0;
  while (!digits.empty()) {
    if (is_digit(digits.front())) {
      ++run;
      digits.remove_prefix(1);
    } else if (digits.starts_with(mark) && run >= 1 && run <= 3 && (groups == 0 || run == 3)) {
      ++groups;
      run = 0;
      digits.remove_prefix(mark.size());
    } else {
      break;
    }
  }
  if (groups == 0 || run != 3) return false;
  if (digits.empty()) return true;
  if (digits.front() != decimal) return false;
  digits.remove_prefix(1);
  return std::all_of(digits.begin(), digits.end(), is_digit);
}

/// What the commas and points of a field say of it.
enum class Reading { kText, kMissing, kWhole, kPoint, kComma, kEither, kThousands, kStamp };

Reading reading_of(std::string_view field) {
  if (says_missing(field) || field == "NaN" || field == "nan") return Reading::kMissing;
  std::string_view unsigned_field = field;
  if (field.front() == '+' || field.front() == '-') unsigned_field.remove_prefix(1);
  const std::size_t exponent = unsigned_field.find_first_of("eE");
  const std::string_view mantissa = unsigned_field.substr(0, exponent);
  std::size_t points = 0, commas = 0, digits = 0, after = 0;
  bool plain = true;
  for (const char c : mantissa) {
    points += c == '.' ? 1 : 0;
    commas += c == ',' ? 1 : 0;
    digits += is_digit(c) ? 1 : 0;
    after = c == '.' || c == ',' ? 0 : after + 1;
    plain = plain && (c == '.' || c == ',' || is_digit(c));
  }
  if (plain && digits > 0 && points + commas <= 1) {
    std::string with_point(field);
    std::replace(with_point.begin(), with_point.end(), ',', '.');
    const auto number = to_number(with_point);
    if (!number)
      return field.find_first_of("eE") == std::string::npos ? Reading::kWhole : Reading::kText;
    if (points == 1) return Reading::kPoint;
    if (commas == 0) return Reading::kWhole;
    const std::size_t before = digits - after;
    const bool may_be_thousands = after == 3 && before >= 1 && before <= 3 &&
                                  mantissa.front() != '0' && exponent == std::string_view::npos;
    return may_be_thousands ? Reading::kEither : Reading::kComma;
  }
  if (time_stamp(field, SlashDate::kUnknown)) return Reading::kStamp;
  if (is_grouped(unsigned_field, ".", ',') || is_grouped(unsigned_field, ",", '.')) {
    return Reading::kThousands;
  }
  for (const std::string_view mark : kGroupMarks) {
    if (is_grouped(unsigned_field, mark, '.') || is_grouped(unsigned_field, mark, ',')) {
      return Reading::kThousands;
    }
  }
  return Reading::kText;
}

bool is_value(const std::string& field) {
  return reading_of(field) != Reading::kText;
}

struct Line {
  std::size_t number = 0;  ///< in the file, from 1
  std::string_view text;
};

std::string_view without_mark(std::string_view comment) {
  comment.remove_prefix(comment.starts_with("//") ? 2 : 1);
  return trimmed(comment);
}

bool in_brackets(std::string_view text) {
  return text.size() > 2 && ((text.front() == '[' && text.back() == ']') ||
                             (text.front() == '(' && text.back() == ')'));
}

/// Whether a row below the names states units: one at least that is known or in brackets, and no
/// number.
bool is_units(const Fields& fields) {
  bool known = false;
  for (const std::string_view text : fields.text) {
    if (in_brackets(text) || config::unit_spelt(text) != nullptr) {
      known = true;
    } else if (!text.empty() && text != "-" && is_value(std::string(text))) {
      return false;
    }
  }
  return known;
}

/// A separator tried on the lines.
class Trial {
 public:
  Trial(char separator, const std::vector<Line>& lines, const std::vector<Line>& comments)
      : separator_(separator) {
    for (const Line& line : lines) rows_.push_back(split(line.text, separator));
    if (rows_.empty()) return;
    learn_body();
    find_names(lines);
    if (!found()) find_no_names(lines, comments);
  }

  bool found() const { return dialect_.lines_before > 0 || headerless_; }
  /// The table has several columns and every row has them all.
  bool splits_all() const { return found() && columns_ > 1 && consistent_; }
  std::size_t columns() const { return columns_; }
  /// Precondition: found().
  Dialect take() { return std::move(dialect_); }
  const Dialect& dialect() const { return dialect_; }
  /// The rows of the table, below names and units.
  std::vector<Fields> body() const {
    return {rows_.begin() + static_cast<std::ptrdiff_t>(first_row_), rows_.end()};
  }

 private:
  /// How many fields the last lines have, and in which of them stand values.
  void learn_body() {
    const std::size_t tail = std::min(rows_.size(), std::max<std::size_t>(2, rows_.size() / 4));
    std::map<std::size_t, std::size_t> counts;
    for (std::size_t i = rows_.size() - tail; i < rows_.size(); ++i) ++counts[rows_[i].count()];
    columns_ = rows_.back().count();
    for (const auto& [columns, count] : counts) {
      if (count > counts[columns_]) columns_ = columns;
    }
    std::vector<std::size_t> values(columns_, 0);
    std::size_t used = 0;
    for (std::size_t i = rows_.size() - tail; i < rows_.size(); ++i) {
      if (rows_[i].count() != columns_) continue;
      ++used;
      for (std::size_t c = 0; c < columns_; ++c) values[c] += is_value(rows_[i].text[c]) ? 1 : 0;
    }
    for (std::size_t c = 0; c < columns_; ++c) is_value_.push_back(2 * values[c] >= used);
  }

  bool is_row(const Fields& fields) const {
    if (fields.count() != columns_) return false;
    bool any = false;
    for (std::size_t c = 0; c < columns_; ++c) {
      if (!is_value_[c]) continue;
      if (!is_value(fields.text[c])) return false;
      any = true;
    }
    return any;
  }

  void find_names(const std::vector<Line>& lines) {
    for (std::size_t i = 0; i + 1 < rows_.size(); ++i) {
      Fields names = separator_ == ' ' ? with_brackets(rows_[i]) : rows_[i];
      const std::size_t below = i + 1;
      const bool units = below + 1 < rows_.size() && rows_[below].count() <= names.count() &&
                         is_units(rows_[below]) && is_row(rows_[below + 1]);
      const std::size_t first = units ? below + 1 : below;
      if (!is_row(rows_[first])) continue;
      // LabVIEW names a column of comments and leaves it out of the rows.
      const bool comment = names.count() == columns_ + 1 && names.text.back() == "Comment";
      if (comment) names.text.pop_back();
      // What R writes has no name above the names of its rows.
      const bool row_names = names.count() + 1 == columns_ && rows_[first].quoted.front();
      // A line that ends in a separator names one more column than the rows have, or one less.
      while (names.count() > columns_ && names.text.back().empty()) names.text.pop_back();
      if (names.count() != columns_ && !row_names) continue;
      const bool named = std::none_of(names.text.begin(), names.text.end(), [](const auto& name) {
        return !name.empty() && is_value(name);
      });
      const bool any = std::any_of(names.text.begin(), names.text.end(),
                                   [](const auto& name) { return !name.empty(); });
      if (!named || !any) continue;
      dialect_.names = std::move(names.text);
      dialect_.row_names = row_names;
      if (row_names) dialect_.names.insert(dialect_.names.begin(), "");
      if (units) {
        dialect_.units = rows_[below].text;
        dialect_.units.resize(columns_);
        for (std::string& unit : dialect_.units) {
          if (in_brackets(unit)) unit = trimmed(std::string_view(unit).substr(1, unit.size() - 2));
        }
      }
      dialect_.names_line = lines[i].number;
      dialect_.lines_before = lines[first].number - 1;
      dialect_.preamble = i;
      first_row_ = first;
      judge();
      return;
    }
  }

  /// Rows from the first line on; their names may stand in the last comment before them.
  void find_no_names(const std::vector<Line>& lines, const std::vector<Line>& comments) {
    // A first line of another form is not passed over.
    if (!is_row(rows_.front())) return;
    dialect_.names = commented_names(lines.front().number, comments);
    dialect_.commented_names = !dialect_.names.empty();
    if (!dialect_.commented_names) {
      const bool all_values =
          std::all_of(is_value_.begin(), is_value_.end(), [](bool value) { return value; });
      if (!all_values) return;
      for (std::size_t c = 1; c <= columns_; ++c) dialect_.names.push_back(std::to_string(c));
    }
    headerless_ = true;
    dialect_.lines_before = lines.front().number - 1;
    judge();
  }

  std::vector<std::string> commented_names(std::size_t before, const std::vector<Line>& comments) {
    const auto after = std::find_if(comments.begin(), comments.end(),
                                    [&](const Line& comment) { return comment.number > before; });
    if (after == comments.begin()) return {};
    const Line& last = *std::prev(after);
    for (const char separator : {separator_, ',', ';', '\t', ' '}) {
      Fields names = split(without_mark(last.text), separator);
      if (separator == ' ') names = with_brackets(std::move(names));
      const bool texts = std::none_of(names.text.begin(), names.text.end(),
                                      [](const auto& name) { return is_value(name); });
      // Of one column anything might be its name.
      const bool is_sentence =
          columns_ == 1 && names.text.front().find_first_of(" :") != std::string::npos;
      if (names.count() != columns_ || !texts || is_sentence) continue;
      dialect_.names_line = last.number;
      return std::move(names.text);
    }
    return {};
  }

  void judge() {
    dialect_.separator = separator_;
    consistent_ = std::all_of(rows_.begin() + static_cast<std::ptrdiff_t>(first_row_), rows_.end(),
                              [&](const Fields& row) { return row.count() == columns_; });
  }

  char separator_;
  std::vector<Fields> rows_;
  std::size_t columns_ = 0, first_row_ = 0;
  std::vector<bool> is_value_;
  Dialect dialect_;
  bool consistent_ = false, headerless_ = false;
};

/// The names are the first line that is no comment, whatever follows.
Dialect by_first_line(const std::vector<Line>& lines) {
  Dialect dialect;
  const Line& first = lines.front();
  for (const char separator : {',', ';', '\t', '|'}) {
    dialect.separator = separator;
    if (split(first.text, separator).count() > 1) break;
    dialect.separator = ',';
  }
  dialect.names = split(first.text, dialect.separator).text;
  dialect.names_line = dialect.lines_before = first.number;
  return dialect;
}

bool all_whole(const std::vector<Fields>& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const Fields& row) {
    return std::all_of(row.text.begin(), row.text.end(), [](const std::string& field) {
      return reading_of(field) == Reading::kWhole;
    });
  });
}

/// Which decimals the rows use, and that they can be read in one way only.
Status learn_decimals(const std::vector<Fields>& rows, Dialect& dialect) {
  std::string comma, point, either;
  for (const Fields& row : rows) {
    for (std::size_t c = 0; c < row.count(); ++c) {
      const std::string& field = row.text[c];
      const Reading reading = reading_of(field);
      if (reading == Reading::kThousands) {
        return unclear(
            fmt::format("found {}, expected numbers without separators of thousands: write them "
                        "without grouping and export again",
                        shown(field)));
      }
      // Unquoted, a comma would have ended the field.
      if (dialect.separator == ',' && !row.quoted[c]) continue;
      if (reading == Reading::kComma) comma = field;
      if (reading == Reading::kPoint) point = field;
      if (reading == Reading::kEither) either = field;
    }
  }
  if (!comma.empty() && !point.empty()) {
    return unclear(
        fmt::format("found {} and {}, expected decimal commas or decimal points, not both",
                    shown(comma), shown(point)));
  }
  if (!either.empty() && comma.empty()) {
    std::string with_point(either), without(either);
    std::replace(with_point.begin(), with_point.end(), ',', '.');
    std::erase(without, ',');
    return unclear(
        fmt::format("found {}: {} or {}? Expected decimal points, or a number with other "
                    "than three decimals among the first rows",
                    shown(either), with_point, without));
  }
  dialect.decimal_comma = !comma.empty();
  return {};
}

/// Whether "3/4/2024" is in March or in April; unknown where the rows do not say.
SlashDate order_of_dates(const std::vector<Fields>& rows) {
  bool day_first = false, month_first = false;
  for (const Fields& row : rows) {
    for (const std::string& field : row.text) {
      if (field.find('/') == std::string::npos) continue;
      const auto stamp = time_stamp(field, SlashDate::kUnknown);
      if (!stamp || !stamp->slashes) continue;
      day_first = day_first || stamp->first > 12;
      month_first = month_first || stamp->second > 12 || field.ends_with('M');
    }
  }
  if (day_first == month_first) return SlashDate::kUnknown;
  return day_first ? SlashDate::kDayFirst : SlashDate::kMonthFirst;
}

}  // namespace

std::string Dialect::says() const {
  constexpr std::array<std::pair<char, std::string_view>, 5> kNames = {
      {{',', "commas"}, {';', "semicolons"}, {'\t', "tabs"}, {'|', "bars"}, {' ', "blanks"}}};
  std::vector<std::string> parts;
  for (const auto& [which, name] : kNames) {
    const bool said = which == separator && (separator != ',' || decimal_comma);
    if (said) parts.push_back(fmt::format("separated by {}", name));
  }
  if (decimal_comma) parts.emplace_back("with decimal commas");
  if (preamble > 0) {
    parts.push_back(fmt::format("{} line{} before the names", preamble, preamble > 1 ? "s" : ""));
  }
  if (commented_names) parts.emplace_back("names in a comment");
  if (names_line == 0 && !names.empty()) {
    parts.push_back(fmt::format("without names: its columns are called {}",
                                names.size() == 1 ? "1" : fmt::format("1 to {}", names.size())));
  }
  if (row_names) parts.emplace_back("the rows' own names left out");
  if (!units.empty()) parts.emplace_back("units in the row below the names");
  if (dates == SlashDate::kDayFirst) parts.emplace_back("dates with the day first");
  if (dates == SlashDate::kMonthFirst) parts.emplace_back("dates with the month first");
  return fmt::format("{}", fmt::join(parts, ", "));
}

bool is_comment(std::string_view line) {
  // A row may begin with "#N/A".
  if (line.starts_with('#') && says_missing(line.substr(0, line.find_first_of(",;|\t ")))) {
    return false;
  }
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
}

Result<Dialect> recognise(std::string_view head, bool whole) {
  std::vector<Line> lines, comments;
  std::size_t number = 0;
  while (!head.empty() && lines.size() < kLinesLookedAt) {
    const std::size_t end = head.find('\n');
    if (end == std::string_view::npos && !whole && number > 0) break;  // cut off
    std::string_view line = head.substr(0, end);
    head.remove_prefix(end == std::string_view::npos ? head.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++number;
    if (!trimmed(line).empty()) (is_comment(line) ? comments : lines).push_back({number, line});
  }
  if (lines.empty()) return Dialect{};

  std::optional<Trial> chosen;
  for (const char separator : {';', '\t', '|', ',', ' '}) {
    const Trial trial(separator, lines, comments);
    // Blanks behind commas separate nothing.
    const bool behind = separator == ' ' && !trial.dialect().names.empty() &&
                        trial.dialect().names.front().ends_with(',');
    if (trial.splits_all() && !behind) {
      chosen = trial;
      break;
    }
  }
  // Something is wrong with a line, or there is one column.
  for (const char separator : {',', ';', '\t', '|'}) {
    if (chosen) break;
    Trial trial(separator, lines, comments);
    if (trial.found() && trial.columns() > 1) chosen = std::move(trial);
  }
  if (!chosen) {
    Trial trial(',', lines, comments);
    const bool one_column = trial.found() && trial.dialect().preamble == 0;
    if (one_column) chosen = std::move(trial);
  }
  Dialect dialect;
  std::vector<Fields> body;
  if (chosen) {
    body = chosen->body();
    dialect = chosen->take();
  } else {
    dialect = by_first_line(lines);
    for (std::size_t i = 1; i < lines.size(); ++i) {
      body.push_back(split(lines[i].text, dialect.separator));
    }
  }
  const bool may_be_one = dialect.names_line == 0 && dialect.separator == ',' &&
                          dialect.names.size() == 2 && !body.empty() && all_whole(body);
  if (may_be_one) {
    const auto& first = body.front().text;
    return unclear(fmt::format(
        "found '{0},{1}' and no names: two columns, or {0}.{1}? Expected a line of names, or "
        "decimal points",
        first[0], first[1]));
  }
  if (Status known = learn_decimals(body, dialect); !known) return known.error();
  dialect.dates = order_of_dates(body);
  return dialect;
}

}  // namespace fogbench::model
