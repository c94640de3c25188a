#pragma once
// Stamps as loggers write them made into seconds that go on: dates, Unix stamps in milli-, micro-
// or nanoseconds, counters that wrap, times of day that pass midnight.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/result.hpp"
#include "model/table/choose_columns.hpp"
#include "model/table/time_stamp.hpp"

namespace fogbench::model {

/// Stamps that are text, as they come.
class TextStamps {
 public:
  /// In seconds since 1970 or since midnight; nothing where the text is no stamp.
  std::optional<double> take(std::string_view text, SlashDate order);
  /// At least one was taken.
  bool any() const { return dates_ + times_ > 0; }
  /// Of all of them: times of day go on over midnight. What there is to say of them. Errors:
  /// kBadInput for dates beside times without a date.
  Result<std::vector<std::string>> settle(std::vector<double>& seconds) const;

 private:
  std::size_t dates_ = 0, times_ = 0, zones_ = 0;
};

/// Numbers of a column `chosen` for time_s, in its unit, to seconds; `run` as of a table's rows,
/// empty for one run. A counter of 16 or 32 bits that falls back to its beginning in step goes on.
/// Where no unit is stated, Unix stamps of the years 2001 to 2100 say by their size what they are
/// in. Returns what there is to say.
Result<std::vector<std::string>> settle_counter(const ChosenColumn& chosen,
                                                std::span<const std::uint32_t> run,
                                                std::vector<double>& values);

}  // namespace fogbench::model
