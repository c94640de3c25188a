#pragma once
// What waits to be run on the bench, in its order, and why it may have to wait for a person. Plain
// state, under the desk's mutex: no thread, no clock.
//
// The reasons for a hold are not kept. They are told anew from what is so: who has asked for it,
// whether the daemon was started anew, how the last run ended, which gyro is on the bench, and the
// job that would begin now. A job that is removed or moved takes its reason with it.

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "daemon/json_rpc.hpp"
#include "daemon/order.hpp"
#include "daemon/session.hpp"

namespace fogbench::daemon {

/// Who asks for something.
struct Person {
  std::string name;
  std::uint32_t uid = 0;
};

struct Job {
  std::uint64_t job = 0;
  Order order;
  PlannedProcedure procedure;
  Person by;
};

class JobQueue {
 public:
  static constexpr std::size_t kMostJobs = 100;
  using Refused = std::optional<RpcError>;

  /// The job's number. A run that is taken up goes before what waits, and what waits goes on after
  /// it. Only one job takes a run up.
  std::variant<std::uint64_t, RpcError> add(Order order, PlannedProcedure procedure,
                                            const Person& by);
  /// One that an earlier daemon had: to the end, and nothing begins until somebody goes on.
  void restore(Order order, PlannedProcedure procedure, const Person& by);
  /// How many jobs an earlier daemon has had: no number is given twice.
  void restore_count(std::uint64_t jobs_ever) { jobs_ever_ = std::max(jobs_ever_, jobs_ever); }
  Refused remove(std::uint64_t job);
  /// To that place; the next to begin has place 1.
  Refused move(std::uint64_t job, std::uint64_t place);
  const std::deque<Job>& jobs() const { return jobs_; }
  /// Null when it is not in the queue.
  const Job* job(std::uint64_t job) const;
  bool takes_up(std::int64_t run) const;

  /// No run begins any more, for that reason, until somebody goes on.
  void hold(std::string because);
  /// The reason that a person gave; empty: nobody has asked for it.
  const std::string& asked_hold() const { return asked_; }
  /// Somebody goes on: all that holds is seen to, and the next job's gyro is on the bench. While a
  /// run is under way only what hold() asked for is undone.
  void go_on();
  /// Of the next job's gyro. Precondition: there is one.
  void switched_on(const SwitchedOn& since);
  /// Why nothing begins until somebody goes on; empty: nothing keeps it.
  std::string held_because() const;

  /// The next job, whose run begins now. Precondition: there is one, and nothing holds it.
  Job take();
  /// Its run is on record.
  void recorded();
  void ended(procedures::RunOutcome outcome, bool safe_state_reached);

  /// What is to be done again if the process died now: the queue, and before it the job whose run
  /// is not on record yet. `changes` rises with every change of it.
  struct Waiting {
    std::uint64_t changes = 0;
    std::uint64_t jobs_ever = 0;
    std::string asked_hold;
    std::vector<std::pair<Order, Person>> orders;
  };
  Waiting waiting() const;

 private:
  std::deque<Job>::iterator find(std::uint64_t job);
  std::string reason_to_hold(const Job& next) const;

  std::deque<Job> jobs_;
  std::uint64_t jobs_ever_ = 0, changes_ = 0;
  std::optional<std::pair<Order, Person>> starting_;  ///< taken, and no run on record yet
  bool running_ = false;                              ///< from take() to ended()
  std::string asked_;
  bool started_anew_ = false;  ///< and nobody has gone on since
  /// Of the last run, when it was not completed and nobody has gone on since.
  std::optional<procedures::RunOutcome> unfinished_;
  bool unsafe_ = false;  ///< and the bench is not in its safe state
  std::string gyro_;     ///< on the bench, as far as runs and people have said; empty: unknown
};

}  // namespace fogbench::daemon
