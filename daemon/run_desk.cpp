#include "daemon/run_desk.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

namespace fogbench::daemon {
namespace {

using Lock = std::lock_guard<std::mutex>;
using procedures::RunOutcome;

RpcError wrong_state(std::string says) {
  return {RpcCode::kWrongState, std::move(says)};
}

std::string data_text(const nlohmann::ordered_json& data) {
  return data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

/// "coil-sweep, gyro FOG-42", or what it takes up.
std::string title_of(const Job& job) {
  std::string title = job.procedure.plan.procedure;
  if (job.order.takes_up != 0) title += fmt::format(", taking up run {}", job.order.takes_up);
  return job.procedure.gyro.empty() ? title : title + ", gyro " + job.procedure.gyro;
}

constexpr auto kNothingRuns = "nothing is running";
constexpr auto kStopping = "the daemon is stopping";

}  // namespace

std::optional<double> DeskView::now_s() const {
  if (!run || run->run == 0) return std::nullopt;
  return (run->progress.started + run->progress.elapsed).count();
}

void RunDesk::note(const std::string& action, const Person& by, std::uint64_t job) {
  changed();
  if (!view_.run) return note_on_bench(action, by);
  nlohmann::ordered_json data{{"action", action}, {"user", by.name}, {"uid", by.uid}};
  if (job != 0) data["job"] = job;
  notes_.push_back({fmt::format("{}, by {}", action, by.name), data_text(data)});
}

void RunDesk::note_on_bench(const std::string& message, const Person& by, const std::string& gyro,
                            std::uint64_t job) {
  nlohmann::ordered_json data{{"action", message}, {"user", by.name}, {"uid", by.uid}};
  if (job != 0) data["job"] = job;
  bench_events_.push_back(
      {calendar_(), "info", fmt::format("{}, by {}", message, by.name), gyro, data_text(data)});
  changed();
}

void RunDesk::happened(const std::string& severity, const std::string& message,
                       const std::string& gyro, const std::string& data_json) {
  const Lock lock(mutex_);
  bench_events_.push_back({calendar_(), severity, message, gyro, data_json});
  changed();
}

std::vector<record::BenchEvent> RunDesk::take_bench_events() {
  const Lock lock(mutex_);
  return std::exchange(bench_events_, {});
}

std::variant<std::uint64_t, RpcError> RunDesk::enqueue(Order order, PlannedProcedure procedure,
                                                       const Person& by) {
  const Lock lock(mutex_);
  if (view_.closing) return wrong_state(kStopping);
  auto added = queue_.add(std::move(order), std::move(procedure), by);
  if (const auto* number = std::get_if<std::uint64_t>(&added)) {
    const Job& job = *queue_.job(*number);
    note_on_bench(fmt::format("job {} queued: {}", *number, title_of(job)), by, job.procedure.gyro,
                  *number);
  }
  return added;
}

RunDesk::Refused RunDesk::remove(std::uint64_t job, const Person& by) {
  const Lock lock(mutex_);
  const Job* const found = queue_.job(job);
  const std::string title = found == nullptr ? "" : title_of(*found);
  const std::string gyro = found == nullptr ? "" : found->procedure.gyro;
  auto refused = queue_.remove(job);
  if (!refused) {
    note_on_bench(fmt::format("job {} removed from the queue: {}", job, title), by, gyro, job);
  }
  return refused;
}

RunDesk::Refused RunDesk::move(std::uint64_t job, std::uint64_t place, const Person& by) {
  const Lock lock(mutex_);
  auto refused = queue_.move(job, place);
  if (!refused) {
    note_on_bench(fmt::format("job {} moved to place {} of the queue", job, place), by,
                  queue_.job(job)->procedure.gyro, job);
  }
  return refused;
}

RunDesk::Refused RunDesk::pause(const Person& by) {
  const Lock lock(mutex_);
  if (!view_.run) return wrong_state(kNothingRuns);
  if (view_.run->abort_requested) return wrong_state("the run is being aborted");
  if (view_.run->pause_requested) return wrong_state("the run was paused already");
  view_.run->pause_requested = true;
  pause_asked_by_ = by.name;
  if (engine_runs_) engine_->request_pause();
  note("pause", by);
  return {};
}

RunDesk::Refused RunDesk::hold(const Person& by) {
  const Lock lock(mutex_);
  if (view_.closing) return wrong_state(kStopping);
  queue_.hold("asked for by " + by.name);
  note("hold the queue", by);
  return {};
}

bool RunDesk::can_still_pause() const {
  if (view_.run->run == 0) return true;
  const std::size_t now = view_.run->progress.step;
  for (std::size_t i = now + 1; i < blocks_.size(); ++i) {
    if (blocks_[i] == 0 || blocks_[i] != blocks_[now]) return true;
  }
  return false;
}

RunDesk::Refused RunDesk::resume(const Person& by, const std::optional<SwitchedOn>& switched_on) {
  const Lock lock(mutex_);
  if (view_.run && view_.run->abort_requested) return wrong_state("the run is being aborted");
  // An interlock may have paused it.
  if (view_.run &&
      (view_.run->pause_requested || view_.run->progress.state == procedures::RunState::kPaused)) {
    view_.run->pause_requested = false;
    if (engine_runs_) engine_->request_resume();
    note("resume", by);
    return {};
  }
  if (queue_.held_because().empty()) {
    return wrong_state(view_.run ? "the run is not paused" : kNothingRuns);
  }
  if (switched_on && queue_.jobs().empty()) {
    return wrong_state("no job waits whose gyro could have been switched on");
  }
  if (switched_on) queue_.switched_on(*switched_on);
  const std::string because = queue_.held_because();
  queue_.go_on();
  note(fmt::format("go on with the queue, which was held ({})", because), by);
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
}

DeskView RunDesk::view() const {
  const Lock lock(mutex_);
  DeskView view = view_;
  view.jobs = queue_.jobs().size();
  view.held_because = queue_.held_because();
  view.interrupted = offered_.last();
  if (view.run && view.run->progress.state != procedures::RunState::kPaused) {
    view.run->pauses_after = view.run->pause_requested && !can_still_pause();
  }
  return view;
}

std::vector<QueuedJob> RunDesk::queue() const {
  const Lock lock(mutex_);
  std::vector<QueuedJob> jobs;
  for (const Job& job : queue_.jobs()) {
    jobs.push_back({job.job, job.procedure.plan.procedure, job.by.name, job.procedure.plan.estimate,
                    job.procedure.gyro, job.order.keep_going});
  }
  return jobs;
}

std::vector<EndedRun> RunDesk::ended_runs() const {
  const Lock lock(mutex_);
  return {ended_.begin(), ended_.end()};
}

JobQueue::Waiting RunDesk::waiting() const {
  const Lock lock(mutex_);
  return queue_.waiting();
}

void RunDesk::restore(Order order, PlannedProcedure procedure, const Person& by) {
  const Lock lock(mutex_);
  queue_.restore(std::move(order), std::move(procedure), by);
  changed();
}

void RunDesk::restore_hold(std::string because) {
  const Lock lock(mutex_);
  queue_.hold(std::move(because));
  changed();
}

void RunDesk::restore_count(std::uint64_t jobs_ever) {
  const Lock lock(mutex_);
  queue_.restore_count(jobs_ever);
}

void RunDesk::offer(InterruptedRun run) {
  const Lock lock(mutex_);
  offered_.add(std::move(run));
  changed();
}

RunDesk::Refused RunDesk::may_discard(std::int64_t run) const {
  const Lock lock(mutex_);
  if (!offered_.has(run)) {
    return RpcError{RpcCode::kNotFound, fmt::format("run {} does not wait to be taken up", run)};
  }
  if (queue_.takes_up(run)) {
    return wrong_state(fmt::format("a job takes up run {}: remove it from the queue first", run));
  }
  return {};
}

void RunDesk::withdraw_offer(std::int64_t run) {
  const Lock lock(mutex_);
  offered_.withdraw(run);
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

void RunDesk::look() {
  const Lock lock(mutex_);
  look_ = true;
  job_or_close_.notify_one();
}

void RunDesk::attach(procedures::RunEngine& engine) {
  const Lock lock(mutex_);
  engine_ = &engine;
}

std::optional<Job> RunDesk::next_job(const std::function<void()>& meanwhile) {
  std::unique_lock lock(mutex_);
  pulse_.waits_for_job = true;
  const auto ready = [this] {
    return view_.closing || (!queue_.jobs().empty() && queue_.held_because().empty());
  };
  while (!ready()) {
    job_or_close_.wait(lock,
                       [&] { return ready() || (meanwhile && (look_ || !bench_events_.empty())); });
    if (ready()) break;
    look_ = false;
    lock.unlock();
    meanwhile();
    lock.lock();
  }
  pulse_.waits_for_job = false;
  if (view_.closing) {
    deserted_ = true;
    return std::nullopt;
  }
  Job job = queue_.take();
  PresentRun run;
  run.job = job.job;
  run.procedure = job.procedure.plan.procedure;
  run.by = job.by.name;
  run.gyro = job.procedure.gyro;
  run.progress.steps = job.procedure.plan.steps.size();
  blocks_.clear();
  for (const auto& step : job.procedure.plan.steps) blocks_.push_back(step.block);
  takes_up_ = job.order.takes_up;
  run.progress.remaining = job.procedure.plan.estimate;
  view_.run = std::move(run);
  view_.values.reset();
  view_.known.clear();
  known_ = {};
  view_.point.reset();
  view_.events.clear();
  block_ = 0;
  block_points_ = 0;
  end_.reset();
  notes_.clear();
  note("run", job.by, job.job);
  return job;
}

void RunDesk::run_begun(std::int64_t run) {
  const Lock lock(mutex_);
  view_.run->run = run;
  offered_.withdraw(takes_up_);
  queue_.recorded();
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
  view_.known = known_.missing(row);
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
  end_ = end;
  changed();
}

void RunDesk::run_ended(const Result<procedures::RunSummary>& summary) {
  const Lock lock(mutex_);
  engine_runs_ = false;
  if (engine_ != nullptr) engine_->withdraw_requests();  // what came too late for it
  const PresentRun& run = *view_.run;
  const auto outcome = summary ? summary->end.outcome : RunOutcome::kFailed;
  EndedRun ended{run.job, run.run, run.procedure, run.by};
  ended.points = run.points;
  ended.gyro = run.gyro;
  // One that did not begin has no end of its own.
  ended.safe_state_reached =
      end_ ? end_->safe_state_reached : engine_ == nullptr || engine_->left_safe();
  ended.outcome = name_of(outcome);
  ended.reason = summary ? summary->end.reason : summary.error().message;
  ended.resumable =
      run.run != 0 && outcome != RunOutcome::kCompleted && run.progress.step < run.progress.steps;
  // An abort says more than the pause before it.
  if (run.pause_requested && outcome != RunOutcome::kAborted) {
    queue_.hold(fmt::format("{} paused run {}, which ended first", pause_asked_by_, run.run));
  }
  queue_.ended(outcome, ended.safe_state_reached);
  if (run.run == 0) {
    bench_events_.push_back(
        {calendar_(),
         "error",
         fmt::format("job {}, {}, could not begin: {}", run.job, run.procedure, ended.reason),
         run.gyro,
         {}});
  }
  ++view_.totals.runs[ended.outcome];
  view_.run.reset();
  view_.question.reset();
  // Nobody reads the bench any more: a current beside "idle" would be none that flows.
  view_.values.reset();
  view_.known.clear();
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
