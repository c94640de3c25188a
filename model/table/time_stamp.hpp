#pragma once
// Dates and times of day as files write them.

#include <optional>
#include <string_view>

namespace fogbench::model {

/// How the first two numbers of "3/4/2024" are meant.
enum class SlashDate { kUnknown, kDayFirst, kMonthFirst };

struct TimeStamp {
  double seconds = 0.0;  ///< since 1970-01-01T00:00:00Z, or since midnight
  bool has_date = false;
  bool has_zone = false;      ///< else the stamp was taken for UTC
  bool slashes = false;       ///< "3/4/2024": meant as `order` says
  int first = 0, second = 0;  ///< of such a date
};

/// "2024-03-01T12:30:05.25+03:00" and its ISO 8601 kin (blank for T, no zone, Z, a comma before the
/// fraction, basic zones, no time), "01.03.2024 12:30:05", "1/3/2024 12:30:05 PM", "12:30:05.25".
/// Empty for any other text, and for a day or hour that does not exist.
std::optional<TimeStamp> time_stamp(std::string_view text, SlashDate order);

}  // namespace fogbench::model
