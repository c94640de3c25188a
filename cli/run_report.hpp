#pragma once
// One run as `show` prints it, and `dry-run` at its end.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "config/result.hpp"
#include "record/run_log_reader.hpp"

namespace fogbench::cli {

/// What made the run, the tables of results and the events. Errors: as the reader's.
Result<std::string> run_text(record::RunLogReader& reader, std::int64_t run);
/// Only the tables of results, without that of every level of every sweep.
Result<std::string> results_text(record::RunLogReader& reader, std::int64_t run);
/// All of it, with the points, as one document.
Result<nlohmann::ordered_json> run_json(record::RunLogReader& reader, std::int64_t run);

}  // namespace fogbench::cli
