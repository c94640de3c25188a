#include "cli/challenge_bench.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <utility>

#include "acceptance/run_table.hpp"
#include "cli/progress_line.hpp"
#include "daemon/abort_on_signal.hpp"
#include "daemon/simulated_operator.hpp"
#include "model/fit/fit.hpp"

namespace fogbench::cli {
namespace {

constexpr auto kRate = "rate_deg_per_h";

/// Keeps the valid points of one run, and nothing else.
class PointRecord final : public procedures::Recorder {
 public:
  Result<std::int64_t> begin_run(const procedures::RunHeader&,
                                 const std::vector<procedures::InstrumentRecord>&) override {
    return std::int64_t{1};
  }
  Status step_started(const std::string&, const std::string&, double) override { return {}; }
  Status step_ended(const std::string&, double, const std::string&) override { return {}; }
  Status event(double, const std::string&, const std::string&, const std::string&) override {
    return {};
  }
  Status point(const procedures::Point& point) override {
    points.push_back(point);
    return {};
  }
  Status void_block(int block, double, const std::string&) override {
    std::erase_if(points, [block](const procedures::Point& p) { return p.block == block; });
    return {};
  }
  Status monitor(const procedures::MonitorRow&) override { return {}; }
  Status gyro_samples(const drivers::GyroBlock&) override { return {}; }
  Status end_run(const procedures::RunEnd&) override { return {}; }

  std::vector<procedures::Point> points;
};

/// What the model leaves of the rate, RMS over the rows.
Result<double> left_by(const config::ModelFile& model, const model::Table& table) {
  const auto fitted = model::fit(
      table, model,
      {.noise = model::FitOptions::Noise::kIndependent, .weight_by = {}, .doubt_rows = false});
  if (!fitted) return fitted.error();
  return fitted->rms;
}

/// The model with a term that is a column of the table.
config::ModelFile with_column(config::ModelFile model, const std::string& column) {
  config::ModelTerm term;
  term.effect = column;
  term.expression = column;
  model.terms.push_back(std::move(term));
  return model;
}

std::vector<double> difference(const model::Table& a, const model::Table& b) {
  const auto first = a.column(kRate), second = b.column(kRate);
  assert(first.size() == second.size());  // what hides changes no temperature and no time
  std::vector<double> result(first.begin(), first.end());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] -= second[i];
  return result;
}

}  // namespace

ChallengeBench::ChallengeBench(const ChallengeDraw& draw, daemon::Setup setup,
                               daemon::PlannedProcedure plan)
    : seed_(draw.bench_seed), setup_(std::move(setup)), plan_(std::move(plan)) {}

Result<ChallengeBench> ChallengeBench::open(const ChallengeDraw& draw) {
  daemon::SetupOptions options;
  if (draw.bench) options.bench = *draw.bench;
  auto setup = daemon::load_setup(options);
  if (!setup) return setup.error();
  daemon::Parameters parameters;
  for (const auto& [name, values] : draw.set) parameters[name] = values;
  auto plan = daemon::plan_procedure(draw.procedure, setup->bench, parameters);
  if (!plan) return plan.error();
  return ChallengeBench(draw, std::move(*setup), std::move(*plan));
}

Result<std::vector<procedures::Point>> ChallengeBench::measure(
    const config::ScenarioConfig& scenario) const {
  daemon::Setup setup = setup_;
  setup.scenario = scenario;
  setup.scenario_json.clear();
  daemon::AbortOnSignal abort_on_signal;
  daemon::SimulatedOperator person;
  PointRecord record;
  auto session =
      daemon::Session::open(std::move(setup), seed_, record, daemon::Speed::kMaximum, person);
  if (!session) return session.error();
  abort_on_signal.attach(**session);
  ProgressLine progress;
  (*session)->engine().on_progress([&](const procedures::Progress& now) { progress.show(now); });
  const auto summary = (*session)->run(plan_);
  progress.clear();
  if (!summary) return summary.error();
  if (summary->end.outcome != procedures::RunOutcome::kCompleted) {
    return Error{summary->end.outcome == procedures::RunOutcome::kAborted ? ErrorCode::kAborted
                                                                          : ErrorCode::kDevice,
                 "the challenge was not measured: " + summary->end.reason};
  }
  return std::move(record.points);
}

Result<SizedChallenge> size_effects(const ChallengeDraw& draw, const ChallengeBench& bench) {
  SizedChallenge sized;
  sized.scenario = draw.scenario;
  sized.scenario.hidden.clear();
  const auto clean_points = bench.measure(sized.scenario);
  if (!clean_points) return clean_points.error();
  model::Table clean = acceptance::to_table(*clean_points);
  const auto noise = left_by(draw.model, clean);
  if (!noise) return noise.error();
  sized.noise_deg_per_h = *noise;

  const auto column = [](std::size_t i) { return fmt::format("hidden_{}", i); };
  const std::size_t count = draw.scenario.hidden.size();
  for (std::size_t i = 0; i < count; ++i) {
    config::ScenarioConfig alone = sized.scenario;
    alone.hidden = {draw.scenario.hidden[i]};
    const auto points = bench.measure(alone);
    if (!points) return points.error();
    clean.set_column(column(i), difference(acceptance::to_table(*points), clean));
  }
  // Always as many runs: neither the progress on a terminal nor the time tells how many hide.
  for (std::size_t i = count; i < kMostHidden; ++i) {
    if (const auto idle = bench.measure(sized.scenario); !idle) return idle.error();
  }
  for (std::size_t i = 0; i < count; ++i) {
    // Beside what the others explain too: two effects must not hide each other.
    config::ModelFile others = draw.model;
    for (std::size_t j = 0; j < count; ++j) {
      if (j != i) others = with_column(std::move(others), column(j));
    }
    model::Table response = clean;
    const auto share = clean.column(column(i));
    response.set_column(kRate, {share.begin(), share.end()});
    const auto visible = left_by(others, response);
    if (!visible) return visible.error();
    config::HiddenEffect effect = draw.scenario.hidden[i];
    effect.amplitude =
        three_digits(effect.amplitude * draw.visibility[i] * sized.noise_deg_per_h / *visible);
    sized.visible_deg_per_h.push_back(std::abs(effect.amplitude) * *visible);
    sized.scenario.hidden.push_back(std::move(effect));
  }
  return sized;
}

}  // namespace fogbench::cli
