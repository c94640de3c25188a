#include "daemon/resumption.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "config/scratch_folder.hpp"
#include "daemon/bench_difference.hpp"
#include "daemon/parameters_json.hpp"
#include "procedures/planned_points.hpp"
#include "procedures/resume_plan.hpp"
#include "procedures/sentence.hpp"

namespace fogbench::daemon {
namespace fs = std::filesystem;
using procedures::Continuation;
using procedures::InstrumentRecord;
using procedures::Plan;

namespace {

Error damaged_header(std::int64_t run) {
  return config::bad_input(fmt::format("run {}: its record of the procedure is damaged", run));
}

/// The whole procedure as it was planned then.
Result<PlannedProcedure> recorded_procedure(const record::StoredRun& run,
                                            const config::BenchConfig& bench) {
  const auto record =
      nlohmann::ordered_json::parse(run.header.procedure_json, nullptr, /*exceptions=*/false);
  if (!record.is_object() || !record.contains("files") || !record.contains("parameters") ||
      !record["files"].is_object() || record["files"].empty()) {
    return damaged_header(run.run);
  }
  const auto parameters = parameters_of(record["parameters"]);
  if (!parameters) return damaged_header(run.run);
  const auto folder = config::ScratchFolder::make();
  if (!folder) return folder.error();
  for (const auto& [name, text] : record["files"].items()) {
    const fs::path file = folder->path() / fs::path(name).filename();
    std::ofstream out(file, std::ios::binary);
    if (!text.is_string() || !(out << text.get_ref<const std::string&>()) || !out.flush()) {
      return Error{ErrorCode::kStore, fmt::format("{}: cannot be written", file.string())};
    }
  }
  const std::string first = record["files"].items().begin().key();
  auto planned = plan_procedure((folder->path() / first).string(), bench, *parameters);
  if (planned) planned->plan.procedure = run.header.procedure;
  return planned;
}

std::optional<std::size_t> index_of(const Plan& plan, std::string_view path) {
  const auto found = std::find_if(plan.steps.begin(), plan.steps.end(),
                                  [&](const auto& step) { return step.path == path; });
  if (found == plan.steps.end()) return std::nullopt;
  return static_cast<std::size_t>(found - plan.steps.begin());
}

/// The index of the step that the run had reached; nothing when the record does not fit the plan.
std::optional<std::size_t> position(const record::StoredRun& run,
                                    const std::vector<record::StoredStep>& steps,
                                    const Plan& whole) {
  const auto last = std::find_if(steps.rbegin(), steps.rend(), [](const record::StoredStep& step) {
    return !step.path.starts_with(procedures::kRedone);
  });
  if (last == steps.rend()) {
    if (!run.header.continues) return 0;
    const std::string& path = run.header.continues->first_step;
    return path.empty() ? whole.steps.size() : index_of(whole, path);
  }
  auto index = index_of(whole, last->path);
  if (index && !std::isnan(last->ended_s)) ++*index;
  return index;
}

/// From the step at `path` on, everything is measured anew: in the last run of the chain that has
/// begun it, and in those after that one.
Result<std::vector<Continuation::Repeated>> repeated(record::RunLogReader& log,
                                                     const std::vector<record::StoredRun>& chain,
                                                     const std::string& path) {
  std::vector<Continuation::Repeated> from;
  for (auto run = chain.rbegin(); run != chain.rend(); ++run) {
    const auto steps = log.steps(run->run);
    if (!steps) return steps.error();
    const auto begun =
        std::find_if(steps->rbegin(), steps->rend(),
                     [&](const record::StoredStep& step) { return step.path == path; });
    if (begun != steps->rend()) {
      from.push_back({run->run, begun->started_s});
      return from;
    }
    from.push_back({run->run, 0.0});
  }
  return std::vector<Continuation::Repeated>{};  // it was never begun
}

/// Points that count and are not measured anew.
Result<std::size_t> measured(record::RunLogReader& log, const std::vector<record::StoredRun>& chain,
                             const std::vector<Continuation::Repeated>& repeated) {
  std::size_t kept = 0;
  for (const record::StoredRun& run : chain) {
    const auto points = log.points(run.run);
    if (!points) return points.error();
    const auto anew = std::find_if(repeated.begin(), repeated.end(),
                                   [&](const auto& from) { return from.run == run.run; });
    for (const record::StoredPoint& point : *points) {
      const bool again = anew != repeated.end() && point.point.time_s >= anew->from_s;
      kept += point.void_because.empty() && !again ? 1 : 0;
    }
  }
  return kept;
}

Status check(const record::StoredRun& run, const Setup& setup) {
  const auto refused = [&](const std::string& why) {
    return config::bad_input(fmt::format("run {} cannot be taken up: {}", run.run, why));
  };
  if (run.completed()) return refused("it was completed");
  if (run.taken_up_by != 0) return refused(fmt::format("run {} did already", run.taken_up_by));
  if (run.header.bench != setup.bench.name) {
    return refused(
        fmt::format("it is of bench {}, expected {}", run.header.bench, setup.bench.name));
  }
  if (const std::string changed = bench_difference(run.header.bench_json, setup.bench_json);
      !changed.empty()) {
    return refused(fmt::format(
        "the points would not be of one bench, whose files have changed since: {}", changed));
  }
  if (run.header.scenario_json != setup.scenario_json) return refused("it is of another scenario");
  return {};
}

/// The same instruments must go on: the points of two gyros are no run.
Status compare(const std::vector<InstrumentRecord>& then,
               const std::vector<InstrumentRecord>& now) {
  for (const InstrumentRecord& before : then) {
    const auto same = [&](const auto& i) { return i.role == before.role; };
    const auto found = std::find_if(now.begin(), now.end(), same);
    const bool there = found != now.end() && found->identity == before.identity &&
                       found->serial_number == before.serial_number;
    if (there) continue;
    const auto name = [](const InstrumentRecord& i) {
      return fmt::format("\"{}\", serial number \"{}\"", i.identity, i.serial_number);
    };
    return Error{
        ErrorCode::kDevice,
        fmt::format("{}: {} answers, expected {}, which measured what is taken up", before.role,
                    found == now.end() ? "nothing" : name(*found), name(before))};
  }
  return {};
}

}  // namespace

Result<PlannedProcedure> plan_resumption(record::RunLogReader& log, std::int64_t run,
                                         const Setup& setup) {
  const bool under_way = log.being_written(run);  // before its record: it may end meanwhile
  const auto chain = log.chain(run);
  if (!chain) return chain.error();
  const record::StoredRun& last = chain->back();
  if (const Status good = check(last, setup); !good) return good.error();
  if (!last.end && under_way) {
    return config::bad_input(fmt::format("run {} cannot be taken up: it is still under way", run));
  }
  auto planned = recorded_procedure(last, setup.bench);
  if (!planned) return planned.error();
  const auto steps = log.steps(run);
  if (!steps) return steps.error();
  const auto at = position(last, *steps, planned->plan);
  if (!at) return damaged_header(run);
  auto resumed = procedures::resume_plan(planned->plan, *at, setup.bench);
  if (!resumed) return resumed.error();

  TakenUp before;
  before.continuation.run = run;
  const bool steps_left = resumed->first < planned->plan.steps.size();
  if (steps_left) {
    before.continuation.first_step = planned->plan.steps[resumed->first].path;
    auto voids = repeated(log, *chain, before.continuation.first_step);
    if (!voids) return voids.error();
    before.continuation.repeated = std::move(*voids);
  }
  const auto kept = measured(log, *chain, before.continuation.repeated);
  if (!kept) return kept.error();
  before.continuation.points = *kept;
  if (!steps_left && *kept == 0 && procedures::measures(planned->plan)) {
    return config::bad_input(fmt::format(
        "run {} cannot be taken up: it has measured nothing, and no step is left of it", run));
  }
  auto instruments = log.instruments(run);
  if (!instruments) return instruments.error();
  before.instruments = std::move(*instruments);
  const auto stopped = log.last_time(run);
  if (!stopped) return stopped.error();
  const auto stepped_s = log.clock_steps_s(run);
  if (!stepped_s) return stepped_s.error();
  const double begun_s = steps->empty() ? *stopped : steps->front().started_s;
  before.stopped_at_s = drivers::seconds_of_utc(last.header.started_at) +
                        std::max(0.0, *stopped - begun_s) + *stepped_s;
  planned->plan = std::move(resumed->plan);
  planned->takes_up = std::move(before);
  planned->gyro = last.header.gyro_serial_number;
  return planned;
}

Result<Continuation> take_up(const PlannedProcedure& procedure, procedures::RunEngine& engine,
                             drivers::Clock& clock) {
  const TakenUp& before = *procedure.takes_up;
  const auto instruments = engine.identify_instruments(procedure.gyro);
  if (!instruments) return instruments.error();
  if (const Status same = compare(before.instruments, *instruments); !same) return same.error();
  Continuation continuation = before.continuation;
  // The calendar may have been set back meanwhile.
  const std::chrono::duration<double> now_s = clock.wall_now().time_since_epoch();
  const double gap_s = std::max(0.0, std::round(now_s.count() - before.stopped_at_s));
  std::vector<std::string> redone;
  for (const procedures::PlannedStep& step : procedure.plan.steps) {
    if (step.path.starts_with(procedures::kRedone)) redone.push_back(step.says);
  }
  continuation.says =
      fmt::format("takes up run {} at step {}, {} after its last trace{}{}", continuation.run,
                  continuation.first_step, procedures::duration_text(config::Seconds{gap_s}),
                  redone.empty() ? "" : "; done again first: ", fmt::join(redone, "; "));
  const nlohmann::ordered_json data{{"run", continuation.run},
                                    {"first_step", continuation.first_step},
                                    {"gap_s", gap_s},
                                    {"redone", redone}};
  continuation.data_json =
      data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  return continuation;
}

Result<std::vector<record::StoredRun>> interrupted_runs(record::RunLogReader& log,
                                                        const Setup& setup) {
  const auto runs = log.runs();
  if (!runs) return runs.error();
  std::vector<record::StoredRun> interrupted;
  for (const record::StoredRun& run : *runs) {
    // A real bench and a dry run of its file have the same name.
    const bool simulated = !run.header.scenario_json.empty();
    const bool ours = run.header.bench == setup.bench.name &&
                      simulated == !setup.scenario_json.empty() && run.taken_up_by == 0;
    if (!ours || run.end || log.being_written(run.run)) continue;
    // It may have ended since it was read.
    auto present = log.run(run.run);
    if (!present) return present.error();
    if (!present->end) interrupted.push_back(std::move(*present));
  }
  return interrupted;
}

}  // namespace fogbench::daemon
