#pragma once
// Which columns of a foreign file are the ones that the model reckons with, and in which unit they
// stand there: as the caller says, as the names and units in the file say, and by the names that
// others commonly give them ("temp", "omega", "Bx"). A column with one candidate is taken and that
// is said; of several none is, and whoever needs it is told which there are.

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "config/result.hpp"
#include "config/stated_unit.hpp"
#include "model/table/read_options.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// As a file has it.
struct SourceColumn {
  std::string name;
  std::string unit;  ///< of a row of units or of an attribute; empty: none
};

struct ChosenColumn {
  std::string name;                           ///< in the table; empty: it is not taken
  const config::StatedUnit* unit = nullptr;   ///< what its numbers are in; null: nobody says
  const config::StatedUnit* house = nullptr;  ///< what the table's are to be in; null: as they are
  bool is_foreign = false;                    ///< the file calls it otherwise
};

struct Choice {
  std::vector<ChosenColumn> columns;  ///< one for each of the source
  std::vector<std::string> says;      ///< what was recognised, for the table's provenance
  /// Columns that several may be, and what to say of that.
  std::vector<std::pair<std::string, std::string>> undecided;
};

/// Errors: kBadInput, without the file's name: a name twice, a column that is to be renamed and is
/// not there, an unknown unit of a column that is wanted, a unit of another kind of number, two
/// units that contradict each other.
Result<Choice> choose_columns(std::span<const SourceColumn> source, const ReadOptions& options);

/// The numbers of the column in the house's unit.
void convert(const ChosenColumn& column, std::vector<double>& values);

}  // namespace fogbench::model
