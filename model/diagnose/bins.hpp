#pragma once
// The table as a diagnosis works on it: complete rows only, a static record joined as a run of its
// own, raw samples averaged into windows so that the work is bounded by the bins, not by the rows.

#include <string>

#include "config/model_file.hpp"
#include "config/result.hpp"
#include "model/table.hpp"

namespace fogbench::model {

/// 1 in the rows of a joined static record, 0 elsewhere.
inline constexpr const char* kQuietColumn = "quiet_record";

struct BinnedTable {
  Table table;
  std::size_t rows_per_bin = 1;
  bool has_quiet_run = false;
};

/// Averages neighbouring rows of one run and segment down to at most 1,500 rows. Errors: kBadInput
/// when the table lacks the observable or no row has it.
Result<BinnedTable> table_for_diagnosis(const Table& table, const config::ModelFile& model,
                                        const Table* quiet);

/// The static record's own bias, as a term of the model.
config::ModelTerm quiet_bias();

}  // namespace fogbench::model
