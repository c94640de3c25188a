#include "daemon/run_desk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/names.hpp"

namespace fogbench::daemon {
namespace {

using Lock = std::lock_guard<std::mutex>;

RpcError wrong_state(std::string says) {
  return {RpcCode::kWrongState, std::move(says)};
}

constexpr auto kNothingRuns = "nothing is running";

}  // namespace

void RunDesk::note(const std::string& action, const Person& by) {
  changed();
  if (!view_.run) return;
  const nlohmann::ordered_json data{{"action", action}, {"user", by.name}, {"uid", by.uid}};
  notes_.push_back({fmt::format("{}, by {}", action, by.name),
                    data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)});
}

std::variant<std::uint64_t, RpcError> RunDesk::enqueue(Order order, PlannedProcedure procedure,
                                                       const Person& by) {
  const Lock lock(mutex_);
  if (view_.closing) return wrong_state("the daemon is stopping");
  if (queue_.size() == kMostJobs) {
    return RpcError{RpcCode::kQueueFull, fmt::format("the queue holds {} runs already", kMostJobs)};
  }
  if (order.takes_up != 0 && takes_up(order.takes_up)) {
    return wrong_state(fmt::format("a job takes up run {} already", order.takes_up));
  }
  // Nothing waits behind what failed: whoever asks now wants this run.
  if (queue_.empty() || order.takes_up != 0) hold_.clear();
  const auto place = order.takes_up != 0 ? queue_.begin() : queue_.end();
  queue_.insert(place, {++jobs_ever_, std::move(order), std::move(procedure), by});
  show_hold();
  ++queue_changes_;
  view_.jobs = queue_.size();
  changed();
  job_or_close_.notify_one();
  return jobs_ever_;
}

RunDesk::Refused RunDesk::remove(std::uint64_t job, const Person& /*by*/) {
  const Lock lock(mutex_);
  const auto found =
      std::find_if(queue_.begin(), queue_.end(), [&](const Job& j) { return j.job == job; });
  if (found == queue_.end()) {
    return RpcError{RpcCode::kNotFound, fmt::format("job {} is not in the queue", job)};
  }
  queue_.erase(found);
  ++queue_changes_;
  if (queue_.empty()) hold_.clear();
  show_hold();
  view_.jobs = queue_.size();
  changed();
  return {};
}

RunDesk::Refused RunDesk::pause(const Person& by) {
  const Lock lock(mutex_);
  if (!view_.run) return wrong_state(kNothingRuns);
  if (view_.run->abort_requested) return wrong_state("the run is being aborted");
  if (view_.run->pause_requested) return wrong_state("the run was paused already");
  view_.run->pause_requested = true;
  if (engine_runs_) engine_->request_pause();
  note("pause", by);
  return {};
}

RunDesk::Refused RunDesk::resume(const Person& by) {
  const Lock lock(mutex_);
  if (view_.run) {
    if (view_.run->abort_requested) return wrong_state("the run is being aborted");
    // An interlock may have paused it.
    const bool paused = view_.run->progress.state == procedures::RunState::kPaused;
    if (!view_.run->pause_requested && !paused) return wrong_state("the run is not paused");
    view_.run->pause_requested = false;
    if (engine_runs_) engine_->request_resume();
    note("resume", by);
    return {};
  }
  if (!view_.held()) return wrong_state(kNothingRuns);
  hold_.clear();
  show_hold();
  changed();
  job_or_close_.notify_one();
  return {};
}

RunDesk::Refused RunDesk::abort(const Person& by) {
  const Lock lock(mutex_);
  if (!view_.run) return wrong_state(kNothingRuns);
  view_.run->abort_requested = true;
  if (engine_runs_) engine_->request_abort();
  note("abort", by);
  return {};
}

RunDesk::Refused RunDesk::answer(std::uint64_t prompt, bool yes, const Person& by) {
  const Lock lock(mutex_);
  if (!view_.question || view_.question->prompt != prompt) {
    return RpcError{RpcCode::kNotFound,
                    fmt::format("prompt {} does not wait for an answer", prompt)};
  }
  if (answer_) {
    return RpcError{RpcCode::kNotFound, fmt::format("prompt {} has been answered", prompt)};
  }
  answer_ = yes;
  note(fmt::format("answer {} to \"{}\"", yes ? "yes" : "no", view_.question->text), by);
  return {};
}

void RunDesk::close(const Person& by) {
  const Lock lock(mutex_);
  view_.closing = true;
  changed();
  if (view_.run && !view_.run->abort_requested) {
    view_.run->abort_requested = true;
    if (engine_runs_) engine_->request_abort();
    note("abort", by);
  }
  job_or_close_.notify_one();
}

DeskView RunDesk::view() const {
  const Lock lock(mutex_);
  return view_;
}

std::vector<QueuedJob> RunDesk::queue() const {
  const Lock lock(mutex_);
  std::vector<QueuedJob> jobs;
  for (const Job& job : queue_) {
    jobs.push_back({job.job, job.procedure.plan.procedure, job.by.name, job.procedure.plan.estimate,
                    job.procedure.gyro});
  }
  return jobs;
}

std::vector<EndedRun> RunDesk::ended_runs() const {
  const Lock lock(mutex_);
  return {ended_.begin(), ended_.end()};
}

RunDesk::Waiting RunDesk::waiting() const {
  const Lock lock(mutex_);
  Waiting waiting{queue_changes_, {}};
  if (starting_) waiting.orders.push_back(*starting_);
  for (const Job& job : queue_) waiting.orders.emplace_back(job.order, job.by);
  return waiting;
}

void RunDesk::offer(InterruptedRun run) {
  const Lock lock(mutex_);
  view_.interrupted = std::move(run);
  changed();
}

void RunDesk::show_hold() {
  view_.held_because = hold_;
  if (hold_.empty() || queue_.empty() || queue_.front().procedure.gyro.empty()) return;
  view_.held_because +=
      fmt::format(", the next needs gyro {} on the bench", queue_.front().procedure.gyro);
}

bool RunDesk::takes_up(std::int64_t run) const {
  return (starting_ && starting_->first.takes_up == run) ||
         std::any_of(queue_.begin(), queue_.end(),
                     [run](const Job& job) { return job.order.takes_up == run; });
}

RunDesk::Refused RunDesk::may_discard(std::int64_t run) const {
  const Lock lock(mutex_);
  if (!view_.interrupted || view_.interrupted->run != run) {
    return RpcError{RpcCode::kNotFound, fmt::format("run {} does not wait to be taken up", run)};
  }
  if (takes_up(run)) {
    return wrong_state(fmt::format("a job takes up run {}: remove it from the queue first", run));
  }
  return {};
}

void RunDesk::withdraw_offer() {
  const Lock lock(mutex_);
  view_.interrupted.reset();
  changed();
}

void RunDesk::hold() {
  const Lock lock(mutex_);
  if (!queue_.empty()) hold_ = "the daemon was started anew";
  show_hold();
  changed();
}

bool RunDesk::aborting() const {
  const Lock lock(mutex_);
  return view_.run && view_.run->abort_requested;
}

RunDesk::Pulse RunDesk::pulse() const {
  const Lock lock(mutex_);
  return pulse_;
}

bool RunDesk::deserted() const {
  const Lock lock(mutex_);
  return deserted_;
}

void RunDesk::bench_waits_for(std::string what) {
  const Lock lock(mutex_);
  view_.bench_waits_for = std::move(what);
  changed();
}

bool RunDesk::still_open() {
  const Lock lock(mutex_);
  ++pulse_.beats;
  return !view_.closing;
}

void RunDesk::attach(procedures::RunEngine& engine) {
  const Lock lock(mutex_);
  engine_ = &engine;
}

std::optional<Job> RunDesk::next_job() {
  std::unique_lock lock(mutex_);
  pulse_.waits_for_job = true;
  job_or_close_.wait(lock, [this] { return view_.closing || (!queue_.empty() && !view_.held()); });
  pulse_.waits_for_job = false;
  if (view_.closing) {
    deserted_ = true;
    return std::nullopt;
  }
  Job job = std::move(queue_.front());
  queue_.pop_front();
  starting_.emplace(job.order, job.by);
  ++queue_changes_;
  view_.jobs = queue_.size();
  PresentRun run;
  run.job = job.job;
  run.procedure = job.procedure.plan.procedure;
  run.by = job.by.name;
  run.gyro = job.procedure.gyro;
  run.progress.steps = job.procedure.plan.steps.size();
  run.progress.remaining = job.procedure.plan.estimate;
  view_.run = std::move(run);
  view_.values.reset();
  view_.point.reset();
  view_.events.clear();
  block_ = 0;
  block_points_ = 0;
  end_.reset();
  notes_.clear();
  note("run", job.by);
  return job;
}

void RunDesk::run_begun(std::int64_t run) {
  const Lock lock(mutex_);
  view_.run->run = run;
  if (starting_ && view_.interrupted && starting_->first.takes_up == view_.interrupted->run) {
    view_.interrupted.reset();
  }
  starting_.reset();
  ++queue_changes_;
  engine_runs_ = true;
  if (view_.run->abort_requested) engine_->request_abort();
  if (view_.run->pause_requested) engine_->request_pause();
  changed();
}

void RunDesk::progressed(const procedures::Progress& progress) {
  const Lock lock(mutex_);
  view_.run->progress = progress;
  ++pulse_.beats;
  changed();
}

void RunDesk::saw(const procedures::MonitorRow& row) {
  const Lock lock(mutex_);
  view_.values = row;
  changed();
}

void RunDesk::saw(const procedures::Point& point) {
  const Lock lock(mutex_);
  view_.point = point;
  ++view_.run->points;
  if (point.block != block_) {
    block_ = point.block;
    block_points_ = 0;
  }
  ++block_points_;
  changed();
}

void RunDesk::saw(const drivers::StreamStatistics& stream) {
  const Lock lock(mutex_);
  view_.totals.stream = stream;
}

void RunDesk::saw(SeenEvent event) {
  const Lock lock(mutex_);
  ++view_.totals.events[event.severity];
  view_.events.push_back(std::move(event));
  if (view_.events.size() > kMostEvents) view_.events.pop_front();
  changed();
}

void RunDesk::voided(int block) {
  const Lock lock(mutex_);
  if (block != block_) return;
  view_.run->points -= block_points_;
  block_points_ = 0;
  changed();
}

void RunDesk::run_ending(const procedures::RunEnd& end) {
  const Lock lock(mutex_);
  engine_runs_ = false;
  end_ = end;
  changed();
}

void RunDesk::run_ended(const Result<procedures::RunSummary>& summary) {
  const Lock lock(mutex_);
  engine_runs_ = false;
  starting_.reset();
  ++queue_changes_;
  EndedRun ended{view_.run->job, view_.run->run, view_.run->procedure, view_.run->by};
  ended.points = view_.run->points;
  ended.gyro = view_.run->gyro;
  // One that did not begin has no end of its own.
  ended.safe_state_reached =
      end_ ? end_->safe_state_reached : engine_ == nullptr || engine_->left_safe();
  ended.outcome = name_of(summary ? summary->end.outcome : procedures::RunOutcome::kFailed);
  ended.reason = summary ? summary->end.reason : summary.error().message;
  if (!queue_.empty()) {
    if (ended.outcome != name_of(procedures::RunOutcome::kCompleted)) {
      hold_ = fmt::format("the last run was not completed ({})", ended.outcome);
    } else if (const std::string& next = queue_.front().procedure.gyro;
               next != ended.gyro && !next.empty() && !ended.gyro.empty()) {
      hold_ = fmt::format("the last run was for gyro {}", ended.gyro);
    }
    show_hold();
  }
  ++view_.totals.runs[ended.outcome];
  view_.run.reset();
  view_.question.reset();
  view_.last_run = ended;
  ended_.push_back(std::move(ended));
  if (ended_.size() > kMostEndedRuns) ended_.pop_front();
  changed();
}

std::vector<Note> RunDesk::take_notes() {
  const Lock lock(mutex_);
  return std::exchange(notes_, {});
}

std::uint64_t RunDesk::ask(const std::string& text) {
  const Lock lock(mutex_);
  view_.question = Question{++prompts_ever_, text};
  answer_.reset();
  changed();
  return prompts_ever_;
}

std::optional<bool> RunDesk::answer_to(std::uint64_t prompt) const {
  const Lock lock(mutex_);
  const bool asked = view_.question && view_.question->prompt == prompt;
  return asked ? answer_ : std::nullopt;
}

void RunDesk::withdraw() {
  const Lock lock(mutex_);
  view_.question.reset();
  answer_.reset();
  changed();
}

}  // namespace fogbench::daemon
