#pragma once
// The desk between the two threads of a serving daemon: orders come in from the control socket's
// thread, the bench's thread takes them and leaves what it sees. Everything on it is under one
// mutex, held for a copy at most; nothing else is shared.
//
// A run's life here:   queued ── next_job ──► starting ── run_begun ──► running, paused, stopping
//                                                ── run_ended ──► among the last runs
//
// What a run asks of the engine (pause, resume, abort) reaches it between run_begun and run_ended
// only, so that an order for one run never falls on the next. A pause that finds no step to hold
// before holds the queue instead. When the queue is held, and why: job_queue.hpp.

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "daemon/job_queue.hpp"
#include "daemon/json_rpc.hpp"
#include "daemon/known_values.hpp"
#include "daemon/offered_runs.hpp"
#include "daemon/session.hpp"
#include "daemon/totals.hpp"
#include "procedures/recorder.hpp"
#include "procedures/run_engine.hpp"
#include "record/run_log.hpp"

namespace fogbench::daemon {

struct QueuedJob {
  std::uint64_t job = 0;
  std::string procedure;
  std::string by;
  config::Seconds estimate{0.0};
  std::string gyro;  ///< serial number, here and below
  bool keep_going = false;
};

struct PresentRun {
  std::uint64_t job = 0;
  std::int64_t run = 0;  ///< its number in the run log; 0 while it starts
  std::string procedure;
  std::string by;
  procedures::Progress progress;
  std::size_t points = 0;
  bool pause_requested = false;
  bool pauses_after = false;  ///< the pause finds no step to hold before: it holds the queue
  bool abort_requested = false;
  std::string gyro;
};

struct EndedRun {
  std::uint64_t job = 0;
  std::int64_t run = 0;  ///< 0: it could not be begun
  std::string procedure;
  std::string by;
  std::string outcome;  ///< completed, aborted, failed
  std::string reason;
  bool safe_state_reached = true;
  std::size_t points = 0;
  std::string gyro;
  bool resumable = false;  ///< not completed, and steps are left
};

struct SeenEvent {
  double time_s = 0.0;
  std::string severity, message;
};

struct Question {
  std::uint64_t prompt = 0;
  std::string text;
};

/// What can be seen from outside, at one moment.
struct DeskView {
  std::uint64_t version = 0;  ///< rises with every change
  std::optional<PresentRun> run;
  std::optional<Question> question;
  std::optional<procedures::MonitorRow> values;  ///< the present run's last
  std::vector<KnownValue> known;                 ///< of those that are missing in it
  std::optional<procedures::Point> point;        ///< the present run's last
  std::deque<SeenEvent> events;                  ///< the last ones, oldest first
  std::optional<EndedRun> last_run;
  std::optional<InterruptedRun> interrupted;  ///< the last one that nobody has decided on
  std::size_t jobs = 0;
  std::string held_because;  ///< why the queue waits for a person; empty: it does not
  bool held() const { return !held_because.empty(); }
  bool closing = false;
  std::string
      bench_waits_for;  ///< what is wrong while an instrument has not begun; empty: all have
  BenchTotals totals;
  /// Since the gyro's power-on, as the times of readings, points and events; null between runs.
  std::optional<double> now_s() const;
};

/// An action for the run's record, with who did it.
struct Note {
  std::string message;
  std::string data_json;
};

class RunDesk {
 public:
  static constexpr std::size_t kMostEvents = 20;
  static constexpr std::size_t kMostEndedRuns = 100;

  // --- The control socket's thread. A refusal is an RpcError.
  using Refused = JobQueue::Refused;
  /// As JobQueue::add.
  std::variant<std::uint64_t, RpcError> enqueue(Order order, PlannedProcedure procedure,
                                                const Person& by);
  Refused remove(std::uint64_t job, const Person& by);
  Refused move(std::uint64_t job, std::uint64_t place, const Person& by);
  /// Before the next divisible step; where none is left, the queue is held after the run.
  Refused pause(const Person& by);
  /// No run begins after the one that is under way, if any.
  Refused hold(const Person& by);
  /// Resumes a run that is paused, else the queue; `switched_on`: the next job's gyro, by the way.
  Refused resume(const Person& by, const std::optional<SwitchedOn>& switched_on = {});
  Refused abort(const Person& by);
  Refused answer(std::uint64_t prompt, bool yes, const Person& by);
  /// No run begins any more; the one under way is aborted. next_job returns.
  void close(const Person& by);
  DeskView view() const;
  std::vector<QueuedJob> queue() const;
  std::vector<EndedRun> ended_runs() const;
  JobQueue::Waiting waiting() const;
  /// What an earlier daemon had in its queue, and a hold that somebody had asked of it.
  void restore(Order order, PlannedProcedure procedure, const Person& by);
  void restore_hold(std::string because);
  void restore_count(std::uint64_t jobs_ever);
  /// Runs that nobody ended, oldest first: each until it is taken up or given up.
  void offer(InterruptedRun run);
  /// Whether a run that was offered may be given up: not when a job takes it up.
  Refused may_discard(std::int64_t run) const;
  void withdraw_offer(std::int64_t run);
  /// The bench's calendar, Unix time in s, for what happens outside of runs; from any thread.
  /// Before anything happens.
  void dated_by(std::function<double()> calendar) { calendar_ = std::move(calendar); }
  /// Something that no run's record tells; on either thread.
  void happened(const std::string& severity, const std::string& message,
                const std::string& gyro = {}, const std::string& data_json = {});
  /// Several times a second: whoever waits for a job has a look at the bench.
  void look();
  /// An abort has been asked for and the bench is not safe yet.
  bool aborting() const;
  /// How the bench's thread is: `beats` rises about once a second while it advances.
  struct Pulse {
    std::uint64_t beats = 0;
    bool waits_for_job = false;
  };
  Pulse pulse() const;
  /// The desk is closed and the bench's thread has seen it.
  bool deserted() const;

  // --- The bench's thread.
  void bench_waits_for(std::string what);
  /// While it waits for something else than a job: it is alive. False when the desk is closed.
  bool still_open();
  /// Before the first job; the engine must outlive the last.
  void attach(procedures::RunEngine& engine);
  /// Waits for one; nothing when the desk is closed. Calls `meanwhile` after each look(), and when
  /// something has happened that it may take.
  std::optional<Job> next_job(const std::function<void()>& meanwhile = {});
  void run_begun(std::int64_t run);
  void progressed(const procedures::Progress& progress);
  void saw(const procedures::MonitorRow& row);
  void saw(const procedures::Point& point);
  void saw(SeenEvent event);
  void saw(const drivers::StreamStatistics& stream);
  void voided(int block);
  /// The bench has been brought to its safe state, or not; the end may have to wait for the run
  /// log.
  void run_ending(const procedures::RunEnd& end);
  void run_ended(const Result<procedures::RunSummary>& summary);
  /// What was done since it was last asked.
  std::vector<Note> take_notes();
  /// What has happened outside of runs, likewise.
  std::vector<record::BenchEvent> take_bench_events();

  std::uint64_t ask(const std::string& text);
  std::optional<bool> answer_to(std::uint64_t prompt) const;
  void withdraw();

 private:
  /// All with the mutex held.
  /// In the run's record, or where there is no run in the bench's.
  void note(const std::string& action, const Person& by, std::uint64_t job = 0);
  void note_on_bench(const std::string& message, const Person& by, const std::string& gyro = {},
                     std::uint64_t job = 0);
  /// Whether the run has a step before which it can hold.
  bool can_still_pause() const;
  void changed() {
    ++view_.version;
    job_or_close_.notify_one();  // what held a job may be gone
  }

  mutable std::mutex mutex_;
  std::condition_variable job_or_close_;
  procedures::RunEngine* engine_ = nullptr;
  Pulse pulse_;
  bool deserted_ = false;
  bool look_ = false;
  bool engine_runs_ = false;  ///< between run_begun and run_ended
  JobQueue queue_;
  std::uint64_t prompts_ever_ = 0;
  DeskView view_;  ///< but for what view() derives
  KnownValues known_;
  std::vector<int> blocks_;  ///< of the present run's steps
  std::string pause_asked_by_;
  std::int64_t takes_up_ = 0;  ///< what the present run takes up; 0: none
  OfferedRuns offered_;
  std::optional<bool> answer_;
  int block_ = 0;  ///< of the last point, and how many points it has
  std::size_t block_points_ = 0;
  std::optional<procedures::RunEnd> end_;
  std::deque<EndedRun> ended_;
  std::vector<Note> notes_;
  std::function<double()> calendar_ = [] { return 0.0; };
  std::vector<record::BenchEvent> bench_events_;
};

}  // namespace fogbench::daemon
