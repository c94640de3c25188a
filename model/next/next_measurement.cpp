#include "model/next/next_measurement.hpp"

#include <algorithm>
#include <utility>

#include "model/diagnose/present_run.hpp"
#include "model/next/experiments.hpp"
#include "model/next/set_choice.hpp"
#include "model/next/unseen_effects.hpp"

namespace fogbench::model {
namespace {

constexpr double kLeastNoise = 1e-9;  // deg/sqrt(h): keeps a perfect fit's noise finite

}  // namespace

std::vector<NextMeasurement> next_measurements(const NextMeasurementInput& given) {
  std::vector<NextMeasurement> out;
  if (given.present.rows() == 0 || (given.ambiguous.empty() && given.not_testable.empty())) {
    return out;
  }
  NextMeasurementInput input = given;
  double& white = input.noise.angle_random_walk_deg_per_sqrt_h;
  white = std::max(white, kLeastNoise);
  const Recorded present = recorded_from(input.present);
  BenchState state = state_of(input.present);
  state.reach = input.reach;
  std::vector<Experiment> experiments = bench_experiments(state);
  for (Experiment& e : experiments) e.record = as_recorded(e.record, input.present);
  std::vector<Experiment> with_present = experiments;
  with_present.push_back({kRepeat, "repeat the present run", present});
  if (auto again = first_point_again(present)) {
    with_present.push_back(
        {"first_point_again",
         "repeat the present run and return to its first point at the end (field and azimuth)",
         std::move(*again)});
  }
  for (const auto& set : input.ambiguous) {
    if (set.empty()) continue;
    const auto lines = SetChoice(input, present, with_present, set).choose();
    out.insert(out.end(), lines.begin(), lines.end());
  }
  const auto shown = experiments_for_unseen(input, present, experiments);
  out.insert(out.end(), shown.begin(), shown.end());
  const auto record = columns_to_record(input);
  out.insert(out.end(), record.begin(), record.end());
  return out;
}

}  // namespace fogbench::model
