#include "daemon/job_queue.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fogbench::daemon {
using procedures::RunOutcome;

namespace {

RpcError not_queued(std::uint64_t job) {
  return {RpcCode::kNotFound, fmt::format("job {} is not in the queue", job)};
}

}  // namespace

std::variant<std::uint64_t, RpcError> JobQueue::add(Order order, PlannedProcedure procedure,
                                                    const Person& by) {
  if (jobs_.size() == kMostJobs) {
    return RpcError{RpcCode::kQueueFull, fmt::format("the queue holds {} runs already", kMostJobs)};
  }
  const std::int64_t run = order.takes_up;
  if (run != 0 && takes_up(run)) {
    return RpcError{RpcCode::kWrongState, fmt::format("a job takes up run {} already", run)};
  }
  // Nothing waits behind what failed: whoever asks now wants this run.
  if (jobs_.empty() || run != 0) {
    unfinished_.reset();
    started_anew_ = false;
  }
  if (run != 0 && !running_) {
    asked_.clear();
    // Who takes a run up has looked whether its gyro is in its place.
    if (!procedure.gyro.empty()) gyro_ = procedure.gyro;
  }
  jobs_.insert(run != 0 ? jobs_.begin() : jobs_.end(),
               {++jobs_ever_, std::move(order), std::move(procedure), by});
  ++changes_;
  return jobs_ever_;
}

void JobQueue::restore(Order order, PlannedProcedure procedure, const Person& by) {
  // A job keeps its number; one that another job has by now gets the next.
  const bool is_free = order.job != 0 && find(order.job) == jobs_.end();
  const std::uint64_t number = is_free ? order.job : jobs_ever_ + 1;
  jobs_ever_ = std::max(jobs_ever_, number);
  jobs_.push_back({number, std::move(order), std::move(procedure), by});
  started_anew_ = true;
  ++changes_;
}

std::deque<Job>::iterator JobQueue::find(std::uint64_t job) {
  return std::find_if(jobs_.begin(), jobs_.end(), [job](const Job& j) { return j.job == job; });
}

const Job* JobQueue::job(std::uint64_t job) const {
  const auto found =
      std::find_if(jobs_.begin(), jobs_.end(), [job](const Job& j) { return j.job == job; });
  return found == jobs_.end() ? nullptr : &*found;
}

void JobQueue::switched_on(const SwitchedOn& since) {
  jobs_.front().order.switched_on = since;
  jobs_.front().procedure.switched_on = since;
  ++changes_;
}

JobQueue::Refused JobQueue::remove(std::uint64_t job) {
  const auto found = find(job);
  if (found == jobs_.end()) return not_queued(job);
  jobs_.erase(found);
  ++changes_;
  return {};
}

JobQueue::Refused JobQueue::move(std::uint64_t job, std::uint64_t place) {
  const auto found = find(job);
  if (found == jobs_.end()) return not_queued(job);
  if (place < 1 || place > jobs_.size()) {
    return RpcError{RpcCode::kNotFound,
                    fmt::format("there is no place {} in a queue of {}", place, jobs_.size())};
  }
  Job moved = std::move(*found);
  jobs_.erase(found);
  jobs_.insert(jobs_.begin() + static_cast<std::ptrdiff_t>(place - 1), std::move(moved));
  ++changes_;
  return {};
}

bool JobQueue::takes_up(std::int64_t run) const {
  return (starting_ && starting_->first.takes_up == run) ||
         std::any_of(jobs_.begin(), jobs_.end(),
                     [run](const Job& job) { return job.order.takes_up == run; });
}

void JobQueue::hold(std::string because) {
  asked_ = std::move(because);
  ++changes_;
}

void JobQueue::go_on() {
  asked_.clear();
  ++changes_;
  if (running_) return;
  unfinished_.reset();
  started_anew_ = false;
  if (!jobs_.empty() && !jobs_.front().procedure.gyro.empty()) {
    gyro_ = jobs_.front().procedure.gyro;
  }
}

std::string JobQueue::reason_to_hold(const Job& next) const {
  if (started_anew_) return "the daemon was started anew";
  // A bench that is not safe, and a person's abort, are no failure of one gyro.
  const bool may_go_on = next.order.keep_going && unfinished_ == RunOutcome::kFailed && !unsafe_;
  if (unfinished_ && !may_go_on) {
    return fmt::format("the last run was not completed ({})", name_of(*unfinished_));
  }
  const std::string& gyro = next.procedure.gyro;
  if (gyro.empty() || gyro_.empty() || gyro == gyro_) return {};
  return fmt::format("the last run was for gyro {}", gyro_);
}

std::string JobQueue::held_because() const {
  if (running_ || jobs_.empty()) return asked_;
  const Job& next = jobs_.front();
  const std::string because = asked_.empty() ? reason_to_hold(next) : asked_;
  if (because.empty() || next.procedure.gyro.empty()) return because;
  return fmt::format("{}, the next needs gyro {} on the bench", because, next.procedure.gyro);
}

Job JobQueue::take() {
  Job job = std::move(jobs_.front());
  jobs_.pop_front();
  starting_.emplace(job.order, job.by);
  starting_->first.job = job.job;
  running_ = true;
  if (!job.procedure.gyro.empty()) gyro_ = job.procedure.gyro;
  ++changes_;
  return job;
}

void JobQueue::recorded() {
  starting_.reset();
  ++changes_;
}

void JobQueue::ended(RunOutcome outcome, bool safe_state_reached) {
  recorded();
  running_ = false;
  unfinished_.reset();
  if (outcome != RunOutcome::kCompleted) unfinished_ = outcome;
  unsafe_ = !safe_state_reached;
}

JobQueue::Waiting JobQueue::waiting() const {
  Waiting waiting{changes_, jobs_ever_, asked_, {}};
  if (starting_) waiting.orders.push_back(*starting_);
  for (const Job& job : jobs_) {
    waiting.orders.emplace_back(job.order, job.by);
    waiting.orders.back().first.job = job.job;
  }
  return waiting;
}

}  // namespace fogbench::daemon
