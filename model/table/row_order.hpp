#pragma once
// In which order the rows of a table were measured, and when. A logger writes a stamp twice, steps
// back, or leaves one out: where the rows stand in order of time otherwise, such a stamp is mended
// from its neighbours, so that one bad row costs neither the time axis nor the field's history.

#include <string>
#include <vector>

#include "model/table/signals.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

struct RowOrder {
  std::vector<std::size_t> rows;   ///< of the table, run by run, in order of time
  std::vector<double> time_s;      ///< of each of `rows`; empty where the table has no time
  bool time_advances = true;       ///< false: too many stamps repeat, the rows follow each other
  std::vector<std::string> notes;  ///< what was mended, with its line
};

/// Runs by name ("2" before "10"). A row that repeats both the time and the value of `observable`
/// of another one of its run was written twice and counts once. Where the rows are shuffled, only
/// repeated stamps can be seen.
RowOrder row_order(const Table& table, const std::string& observable);

/// The stamps of some run are a calendar's: time_since_power_on_s then counts from the run's first
/// row.
bool has_calendar_time(const Signals& signals);

/// What to say then.
inline constexpr const char* kCalendarNote =
    "time_s is a calendar's, and nobody knows when the power came on: a warm-up is counted from "
    "the "
    "first row of each run.";

/// The table with mended stamps, its rows as they stand; `notes` as above.
std::vector<std::string> mend_stamps(Table& table, const std::string& observable);

}  // namespace fogbench::model
