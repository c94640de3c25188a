#pragma once
// Taking up a run that was not completed: a crash, a power cut, a fault, an abort. The run log is
// the journal: a step is on record before it acts, a point before anybody hears of it.
//
// The run that takes it up is a new one, with a number, a stream and a record of its own, and names
// the old one. What the old one measured stays, but for the step that was interrupted and, of an
// indivisible block or a heating, all of it (resume_plan.hpp): that is void there and measured
// anew. Both together are one set of measurements (RunLogReader::chain_points).

#include <cstdint>
#include <vector>

#include "daemon/session.hpp"
#include "record/run_log_reader.hpp"

namespace fogbench::daemon {

/// Planned from the files' texts in the record, whatever has become of the files, and for the gyro
/// of the record: an operator confirms that it is still in its place. Errors: kBadInput
/// when there is no such run, it was completed or taken up already, or bench, instruments' files or
/// scenario are not those of the record; kLimit; kStore.
Result<PlannedProcedure> plan_resumption(record::RunLogReader& log, std::int64_t run,
                                         const Setup& setup);

/// What the run that takes up another says of it, when the instruments are those of the record.
/// Precondition: `procedure` takes one up. Errors: kDevice, and the instruments'.
Result<procedures::Continuation> take_up(const PlannedProcedure& procedure,
                                         procedures::RunEngine& engine, drivers::Clock& clock);

/// The runs of this bench that nobody ended, took up or gave up, oldest first, whatever came after
/// them. What another program writes at this moment does not count, nor does a dry run of a real
/// bench's file.
Result<std::vector<record::StoredRun>> interrupted_runs(record::RunLogReader& log,
                                                        const Setup& setup);

}  // namespace fogbench::daemon
