#include "model/table/time_stamp.hpp"

#include <charconv>
#include <chrono>
#include <cmath>

#include "model/table/text_fields.hpp"

namespace fogbench::model {
namespace {

constexpr double kMinute = 60.0, kHour = 3600.0;

/// Takes pieces off the front of a text.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : text_(text) {}
  bool empty() const { return text_.empty(); }
  char front() const { return text_.empty() ? '\0' : text_.front(); }
  bool take(char c) {
    if (front() != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  bool take(std::string_view word) {
    if (!text_.starts_with(word)) return false;
    text_.remove_prefix(word.size());
    return true;
  }
  /// A number of `least` to `most` digits.
  std::optional<int> digits(std::size_t least, std::size_t most) {
    std::size_t count = 0;
    while (count < text_.size() && count < most && text_[count] >= '0' && text_[count] <= '9') {
      ++count;
    }
    if (count < least) return {};
    int value = 0;
    std::from_chars(text_.data(), text_.data() + count, value);
    text_.remove_prefix(count);
    return value;
  }
  void skip_blanks() {
    while (take(' ')) {
    }
  }
  /// What stands behind a point or comma, 0 <= fraction < 1.
  double fraction() {
    double value = 0.0, place = 0.1;
    while (front() >= '0' && front() <= '9') {
      value += place * (front() - '0');
      place /= 10.0;
      text_.remove_prefix(1);
    }
    return value;
  }

 private:
  std::string_view text_;
};

bool take_date(Cursor& at, SlashDate order, TimeStamp& stamp) {
  Cursor ahead = at;
  int year = 0, month = 0, day = 0;
  const auto first = ahead.digits(1, 4);
  if (!first) return false;
  const char mark = ahead.front();
  if ((mark != '-' && mark != '.' && mark != '/') || !ahead.take(mark)) return false;
  const auto second = ahead.digits(1, 2);
  if (!second || !ahead.take(mark)) return false;
  const auto third = ahead.digits(1, 4);
  if (!third) return false;
  if (*first > 31) {
    year = *first;
    month = *second;
    day = *third;
  } else {
    if (mark == '-' || *third < 1000) return false;
    year = *third;
    stamp.slashes = mark == '/';
    stamp.first = *first;
    stamp.second = *second;
    const bool month_first = mark == '/' && order == SlashDate::kMonthFirst;
    month = month_first ? *first : *second;
    day = month_first ? *second : *first;
  }
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  // Which of two numbers is the month may not be known yet.
  const bool undecided = stamp.slashes && order == SlashDate::kUnknown;
  if (!date.ok() && !undecided) return false;
  if (date.ok()) {
    stamp.seconds =
        std::chrono::duration<double>(std::chrono::sys_days(date).time_since_epoch()).count();
  }
  stamp.has_date = true;
  at = ahead;
  return true;
}

bool take_time(Cursor& at, TimeStamp& stamp) {
  const auto hour = at.digits(1, 2);
  if (!hour || !at.take(':')) return false;
  const auto minute = at.digits(2, 2);
  if (!minute) return false;
  double second = 0.0;
  if (at.take(':')) {
    const auto whole = at.digits(2, 2);
    if (!whole) return false;
    second = *whole;
    if (at.take('.') || at.take(',')) second += at.fraction();
  }
  at.skip_blanks();
  int hours = *hour;
  const bool morning = at.take("AM") || at.take("am");
  const bool evening = !morning && (at.take("PM") || at.take("pm"));
  if (morning || evening) {
    if (hours < 1 || hours > 12) return false;
    hours = hours % 12 + (evening ? 12 : 0);
  }
  if (hours > 24 || *minute > 59 || second >= 61.0) return false;
  stamp.seconds += hours * kHour + *minute * kMinute + second;
  return true;
}

/// "Z", "UTC", "+03:00", "-0330", "+03", with the zone's own name behind it.
bool take_zone(Cursor& at, TimeStamp& stamp) {
  if (at.take('Z') || at.take("UTC") || at.take("GMT")) {
    stamp.has_zone = true;
    return true;
  }
  const bool east = at.front() == '+';
  if (!at.take('+') && !at.take('-')) return at.empty();
  const auto hours = at.digits(2, 2);
  if (!hours || *hours > 14) return false;
  at.take(':');
  const int minutes = at.digits(2, 2).value_or(0);
  const double offset = *hours * kHour + minutes * kMinute;
  stamp.seconds += east ? -offset : offset;
  stamp.has_zone = true;
  return true;
}

}  // namespace

std::optional<TimeStamp> time_stamp(std::string_view text, SlashDate order) {
  Cursor at(trimmed(text));
  TimeStamp stamp;
  if (take_date(at, order, stamp)) {
    if (at.empty()) return stamp;
    if (!at.take('T')) at.skip_blanks();
  }
  if (!take_time(at, stamp)) return {};
  at.skip_blanks();
  if (!take_zone(at, stamp) || !at.empty()) return {};
  return stamp;
}

}  // namespace fogbench::model
