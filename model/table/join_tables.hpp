#pragma once
// Tables of several loggers made into one, on their time stamps.

#include <string>
#include <vector>

#include "config/result.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

struct Joined {
  Table table;
  std::vector<std::string> says;  ///< of each further table what became of it
};

/// The first table with what the others add. One with the same columns goes on where the one before
/// it ends; one with others gives each row the values of its own row that is nearest in time,
/// within `tolerance_s` (NaN: half the longer of the two usual steps), else none. `names` are the
/// tables', for sentences. Errors: kBadInput for a table without time_s or with several runs, for
/// one that goes back in time, and where no row finds a neighbour.
Result<Joined> join_tables(std::vector<Table> tables, const std::vector<std::string>& names,
                           double tolerance_s);

}  // namespace fogbench::model
