#include "tests/system/fault_matrix.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "daemon/desk_operator.hpp"
#include "daemon/desk_recorder.hpp"
#include "drivers/open_bench.hpp"
#include "procedures/expand.hpp"
#include "simulator/simulated_bench.hpp"
#include "tests/procedures/procedure_builder.hpp"
#include "tests/support/source_tree.hpp"

namespace fogbench::system_test {
namespace {

using config::Axis;
using procedures::test::step;

constexpr double kBiasDegPerH = 0.7;

procedures::Plan make_short_plan(const config::BenchConfig& bench) {
  const auto no_calls = [](const std::string& name, const config::ProcedureConfig&) {
    return Result<config::ProcedureConfig>(Error{ErrorCode::kBadInput, name});
  };
  const auto written = procedures::test::procedure(
      "short", {step(config::SetTemperature{24.0, config::HeatingMode::kNormal}),
                step(config::Average{20.0, "heating"}), step(config::CompensateField{0.2}),
                step(config::Sweep{Axis::kX, std::vector{0.0, 60.0, 0.0}, 10.0, 1.0, "coil_x"}),
                step(config::Rotate{90.0}), step(config::CompensateField{0.2}),
                step(config::Sweep{Axis::kZ, std::vector{0.0, 60.0}, 10.0, 1.0, "coil_z"}),
                step(config::SetTemperature{0.0, config::HeatingMode::kOff}),
                step(config::Average{10.0, "cooling"})});
  const auto steps = procedures::expand(written, {}, no_calls);
  EXPECT_TRUE(steps) << steps.error().message;
  const auto plan = procedures::make_plan("short", *steps, bench);
  EXPECT_TRUE(plan) << plan.error().message;
  return *plan;
}

std::string off(const procedures::Point& p, const char* what, double value, double truth,
                double allowed) {
  if (std::abs(value - truth) <= allowed) return {};
  return fmt::format("{} at {:.0f} s: {} is {}, the truth is {} +- {}", p.segment, p.time_s, what,
                     value, truth, allowed);
}

}  // namespace

config::BenchConfig quiet_bench() {
  static const auto bench =
      config::load_bench(tests::source_tree() / "config/benches/simulated.json");
  EXPECT_TRUE(bench) << bench.error().message;
  config::BenchConfig quiet = *bench;
  quiet.simulation.magnetic.ambient_steps_per_h = 0.0;
  return quiet;
}

Trial run_with(const std::optional<config::FaultSpec>& fault, const config::BenchConfig& config) {
  const procedures::Plan plan = make_short_plan(config);
  config::ScenarioConfig scenario;
  scenario.noise.angle_random_walk_deg_per_sqrt_h = 0.001;
  scenario.terms = {{"bias", kBiasDegPerH}};
  if (fault) scenario.faults = {*fault};

  Trial trial;
  drivers::VirtualClock clock;
  // As fogbenchd has it: between the engine and the record stands the operators' desk.
  daemon::RunDesk desk;
  daemon::DeskRecorder record(trial.log, desk);
  daemon::DeskOperator person(desk);
  auto ends = simulator::simulate_bench(config, scenario, 1, clock);
  EXPECT_TRUE(ends) << ends.error().message;
  auto bench = drivers::open_bench(config, *std::move(ends), clock, person);
  trial.opened = static_cast<bool>(bench);
  if (!bench) {
    trial.open_error = bench.error().message;
    return trial;
  }
  procedures::RunEngine engine(config, *bench, clock, person, record);
  engine.wait_for_record();
  engine.on_progress([&desk](const procedures::Progress& now) { desk.progressed(now); });
  desk.attach(engine);
  person.attach(engine);
  desk.enqueue({}, {plan, {}, {}}, {"alice", 1000});
  const auto job = desk.next_job();
  const auto summary = engine.run(job->procedure.plan, {});
  desk.run_ended(summary);
  EXPECT_TRUE(summary) << summary.error().message;
  if (summary) {
    trial.summary = *summary;
    const auto shown = desk.view().last_run;
    EXPECT_EQ(shown->outcome, name_of(summary->end.outcome));
    EXPECT_EQ(shown->safe_state_reached, summary->end.safe_state_reached);
    EXPECT_EQ(shown->points, summary->points);
  }
  trial.ended_s = drivers::to_seconds(clock.now().time_since_epoch());
  return trial;
}

std::string wrong_point(const Trial& trial) {
  for (const procedures::Point& p : trial.log.points) {
    std::vector<std::string> all = {
        off(p, "the rate, deg/h", p.rate_deg_per_h, kBiasDegPerH,
            5.0 * p.rate_std_error_deg_per_h + 0.01),
        // 9 W for three minutes: between the room and a little above the target.
        off(p, "the temperature, degC", p.temperature_c, 22.5, 2.0),
        off(p, "the room, degC", p.ambient_c, 21.0, 0.5)};
    if (p.segment.starts_with("coil_")) {
      const bool x = p.segment.starts_with("coil_x");
      all.push_back(off(p, "the field, uT", x ? p.field_x_ut : p.field_z_ut, p.field_set_ut, 1.0));
      all.push_back(off(p, "the other field, uT", x ? p.field_z_ut : p.field_x_ut, 0.0, 2.5));
    }
    for (const std::string& sentence : all) {
      if (!sentence.empty()) return sentence;
    }
  }
  return {};
}

}  // namespace fogbench::system_test
