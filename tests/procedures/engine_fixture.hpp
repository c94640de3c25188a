#pragma once
// A run engine on the bench of fakes, with plans made from steps as a procedure's file has them.

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "procedures/expand.hpp"
#include "procedures/run_engine.hpp"
#include "tests/procedures/procedure_builder.hpp"
#include "tests/support/fake_bench.hpp"
#include "tests/support/memory_recorder.hpp"

namespace fogbench::procedures::test {

class Rig {
 public:
  Rig() { config.gyro.reference_rate = config::DegPerHour{10.0}; }

  Plan plan(std::vector<config::Step> steps) const {
    const auto no_calls = [](const std::string& name, const config::ProcedureConfig&) {
      return Result<config::ProcedureConfig>(Error{ErrorCode::kBadInput, name});
    };
    const auto expanded = expand(procedure("p", std::move(steps)), {}, no_calls);
    EXPECT_TRUE(expanded) << expanded.error().message;
    const auto made = make_plan("p", *expanded, config);
    EXPECT_TRUE(made) << made.error().message;
    return *made;
  }
  Result<RunSummary> run(std::vector<config::Step> steps) {
    return engine.run(plan(std::move(steps)), RunHeader{});
  }
  /// Expects a run that was begun and recorded.
  RunSummary summary_of(std::vector<config::Step> steps) {
    const auto summary = run(std::move(steps));
    EXPECT_TRUE(summary) << summary.error().message;
    return summary ? *summary : RunSummary{};
  }

  config::BenchConfig config;
  fogbench::test::FakePlant plant;
  drivers::Bench bench = fogbench::test::fake_bench(plant);
  fogbench::test::FakeOperator person{plant};
  fogbench::test::MemoryRecorder log;
  RunEngine engine{config, bench, plant.clock, person, log};
};

inline config::Step heat(double target_c, HeatingMode mode = HeatingMode::kNormal) {
  return step(config::SetTemperature{target_c, mode});
}
inline config::Step settle(double timeout_s = 600.0, const std::string& segment = "") {
  return step(config::SettleTemperature{0.2, 20.0, 1.0, timeout_s, segment, 5.0});
}
inline config::Step ramp(double to_c, double rate_c_per_h, const std::string& segment = "") {
  return step(config::Ramp{to_c, rate_c_per_h, HeatingMode::kBoost, false, segment, 5.0});
}
inline config::Step average(double duration_s = 10.0, const std::string& segment = "a") {
  return step(config::Average{duration_s, segment});
}
inline config::Step wait(double duration_s, const std::string& segment = "") {
  return step(config::Wait{duration_s, 0.0, segment, 5.0});
}
inline config::Step compensate() {
  return step(config::CompensateField{0.2});
}
inline config::Step sweep(Axis axis, std::vector<double> levels_ut, double duration_s = 5.0) {
  return step(config::Sweep{axis, std::move(levels_ut), duration_s, 1.0,
                            std::string("coil_") + "xyz"[static_cast<int>(axis)]});
}
inline config::Step rotate(double azimuth_deg) {
  return step(config::Rotate{azimuth_deg});
}

/// Every kind of step once, short.
inline std::vector<config::Step> everything() {
  return {step(config::Prompt{"ready?"}),
          step(config::Baseline{3.0, "thermostat/baseline"}),
          heat(31.0, HeatingMode::kBoost),
          settle(600.0, "thermostat/heating"),
          average(3.0, "thermostat/plateau"),
          wait(3.0),
          compensate(),
          sweep(Axis::kY, {0.0, 50.0, -50.0, 0.0}, 2.0),
          rotate(90.0),
          compensate(),
          sweep(Axis::kZ, {0.0, 50.0}, 2.0)};
}

}  // namespace fogbench::procedures::test
