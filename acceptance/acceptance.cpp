#include "acceptance/acceptance.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

#include "acceptance/conditions.hpp"
#include "acceptance/run_table.hpp"
#include "config/paths.hpp"
#include "model/compare/contrast.hpp"
#include "model/compare/repeatability.hpp"
#include "model/effects/catalogue.hpp"
#include "model/table/table.hpp"
#include "record/export.hpp"

namespace fogbench::acceptance {
using model::Measured;
using procedures::Point;

namespace {

constexpr auto kPer100Ut = "deg/h per 100 uT";

/// The ready model of what these points excite; empty when it is nothing.
std::string model_for(const std::vector<Point>& points) {
  const bool heated = std::any_of(points.begin(), points.end(),
                                  [](const Point& point) { return point.heater_w > 0.0; });
  const bool swept = std::any_of(points.begin(), points.end(), [](const Point& point) {
    return std::isfinite(point.field_set_ut);
  });
  if (heated && swept) return "general";
  return heated ? "thermal" : swept ? "magnetic" : "";
}

Result<std::optional<config::ModelFile>> choose_model(const std::vector<Point>& points,
                                                      const AcceptanceOptions& options) {
  const std::string name = model_for(points);
  if (options.model || name.empty()) return options.model;
  const auto file = config::find_config("models", name);
  if (!file) return file.error();
  auto ready = config::load_model(*file);
  if (!ready) return ready.error();
  return std::optional(std::move(*ready));
}

Result<TestResults> results_of(const std::vector<Point>& points, const AcceptanceOptions& options) {
  TestResults test;
  test.results = derive_results(points);
  const auto chosen = choose_model(points, options);
  if (!chosen) return chosen.error();
  if (*chosen) {
    test.model = (*chosen)->name;
    // Every point that was accepted counts.
    auto fitted = model::fit(to_table(points), **chosen, {.weight_by = {}, .doubt_rows = false});
    if (fitted) {
      test.fit = std::move(*fitted);
    } else {
      test.fit_problem = fitted.error().message;
    }
  }
  auto set_points = set_points_of(points, test.fit ? &*test.fit : nullptr);
  if (!set_points) return set_points.error();
  test.set_points = std::move(*set_points);
  return test;
}

Result<double> k_error(const SweepResult& sweep, const model::FitResult& fit) {
  // K is per 100 uT.
  const double span = (sweep.highest.field_set_ut - sweep.lowest.field_set_ut) / 100.0;
  const auto window = [span](const Point& point, double sign) {
    return model::WeightedWindow{sign / span, point.time_s, point.duration_s,
                                 point.rate_std_error_deg_per_h};
  };
  return model::contrast_standard_error({window(sweep.highest, 1.0), window(sweep.lowest, -1.0)},
                                        fit);
}

/// Of the test's set points.
model::Conditions conditions_at(const std::vector<SetPoint>& set_points) {
  std::vector<Point> points(set_points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].temperature_c = set_points[i].temperature_c;
  }
  return conditions_at_rest(points);
}

/// `points` are the test's.
Status add_measured(const TestResults& test, const std::vector<Point>& points,
                    std::vector<Measured>& out) {
  const auto known = [&](const std::string& quantity) {
    return std::any_of(out.begin(), out.end(), [&](const Measured& m) {
      return m.test == test.name && m.quantity == quantity;
    });
  };
  if (test.fit) {
    for (const model::Estimate& e : test.fit->estimates) {
      if (e.held || !e.unexcited.empty()) continue;
      out.push_back({e.name, test.name, e.unit, e.value, e.standard_error, e.coverage_factor,
                     conditions_of(e.name, points)});
    }
  }
  for (const SweepResult& sweep : test.results.sweeps) {
    const std::string quantity = fmt::format("K_{}", sweep.axis);
    if (std::isnan(sweep.k_deg_per_h.value) || known(quantity)) continue;
    double error = model::kMissing;
    if (test.fit) {
      const auto found = k_error(sweep, *test.fit);
      if (!found) return found.error();
      error = *found;
    }
    out.push_back({quantity, test.name, kPer100Ut, sweep.k_deg_per_h.value, error, 2.0,
                   conditions_of(quantity, points)});
  }
  const PooledSigma pooled = pooled_sigma(test.set_points);
  if (pooled.degrees_of_freedom > 0.0) {
    out.push_back({"temperature_sigma", test.name, "deg/h", pooled.sigma_deg_per_h.value,
                   pooled.sigma_deg_per_h.standard_error,
                   model::coverage_factor(pooled.degrees_of_freedom),
                   conditions_at(test.set_points)});
  }
  return {};
}

/// A term that the fit holds at zero was not seen: a value without an uncertainty.
void add_measured(const NoiseTerms& terms, const std::string& test,
                  const std::vector<Point>& points, std::vector<Measured>& out) {
  if (!terms.fit) return;
  std::vector<Point> within;
  std::copy_if(points.begin(), points.end(), std::back_inserter(within), [&](const Point& point) {
    return point.time_s >= terms.stretch.from_s && point.time_s <= terms.stretch.to_s;
  });
  const model::Conditions at = conditions_at_rest(within);
  const config::NoiseCoefficients& n = terms.fit->noise;
  const config::NoiseCoefficients& e = terms.fit->standard_error;
  out.push_back({"angle_random_walk", test, "deg/sqrt(h)", n.angle_random_walk_deg_per_sqrt_h,
                 e.angle_random_walk_deg_per_sqrt_h, 2.0, at});
  out.push_back({"bias_instability", test, "deg/h", n.bias_instability_deg_per_h,
                 e.bias_instability_deg_per_h, 2.0, at});
  out.push_back({"rate_random_walk", test, "deg/h/sqrt(h)", n.rate_random_walk_deg_per_h_per_sqrt_h,
                 e.rate_random_walk_deg_per_h_per_sqrt_h, 2.0, at});
}

/// The magnetic coefficients that the test's fit determined, with their covariance.
model::RunCoefficients magnetic_coefficients(const TestResults& test,
                                             std::vector<std::string>& names) {
  model::RunCoefficients out{.run = test.name};
  std::vector<double> values;
  std::vector<Eigen::Index> rows;
  Eigen::Index row = -1;
  names.clear();
  for (const model::Estimate& e : test.fit->estimates) {
    if (e.held) continue;
    ++row;
    if (!model::is_field_sensitivity(e.name) || !std::isfinite(e.standard_error)) continue;
    names.push_back(e.name);
    values.push_back(e.value);
    rows.push_back(row);
  }
  const auto n = static_cast<Eigen::Index>(rows.size());
  out.values = Eigen::Map<const Eigen::VectorXd>(values.data(), n);
  out.covariance = test.fit->covariance(rows, rows);
  return out;
}

std::vector<model::RunChange> changes_of(const std::vector<TestResults>& tests) {
  std::vector<model::RunChange> changes;
  std::optional<model::RunCoefficients> before;
  std::vector<std::string> names_before, names;
  for (const TestResults& test : tests) {
    if (!test.fit) continue;
    auto now = magnetic_coefficients(test, names);
    if (names.size() < 2) continue;
    if (before && names == names_before) {
      changes.push_back(model::change_between(*before, now, names, kPer100Ut));
    }
    before = std::move(now);
    names_before = names;
  }
  return changes;
}

Result<RunProvenance> provenance_of(record::RunLogReader& reader, std::int64_t number) {
  auto run = reader.run(number);
  if (!run) return run.error();
  auto instruments = reader.instruments(number);
  if (!instruments) return instruments.error();
  auto hash = reader.raw_sha256(number);
  if (!hash) return hash.error();
  RunProvenance made{std::move(*run), std::move(*instruments), std::move(*hash)};
  // Nobody ended an interrupted run: there is nothing to hold its data against.
  const bool ended = made.run.end && made.run.end->outcome != procedures::RunOutcome::kInterrupted;
  made.raw_data_intact = !ended || made.raw_sha256 == made.run.raw_sha256;
  return made;
}

/// On the run's own axis of time, which is that of its raw stream.
Result<std::optional<QuietStretch>> own_stretch(record::RunLogReader& reader, std::int64_t run) {
  const auto stored = reader.points(run);
  if (!stored) return stored.error();
  std::vector<Point> points;
  for (const record::StoredPoint& point : *stored) {
    if (point.void_because.empty()) points.push_back(point.point);
  }
  return quiet_stretch(points);
}

/// Where the run and those that it takes up come from.
Status add_provenance(record::RunLogReader& reader, std::int64_t number, Acceptance& out) {
  const auto parts = reader.chain(number);
  if (!parts) return parts.error();
  for (const record::StoredRun& part : *parts) {
    auto made = provenance_of(reader, part.run);
    if (!made) return made.error();
    made->taken_up = part.run != number;
    out.runs.push_back(std::move(*made));
    if (const std::string& gyro = part.header.gyro_serial_number; gyro != out.gyro()) {
      return Error{
          ErrorCode::kBadInput,
          fmt::format("run {} is of gyro \"{}\" and run {} of \"{}\"; expected runs of one gyro",
                      out.runs.front().run.run, out.gyro(), part.run, gyro)};
    }
  }
  return {};
}

/// The noise terms of the longest stretch at rest in these runs; all their raw data are checked.
Result<std::optional<NoiseTerms>> longest_noise(record::RunLogReader& reader,
                                                std::span<const RunProvenance> runs) {
  std::optional<NoiseTerms> longest;
  for (const RunProvenance& made : runs) {
    const auto stretch = own_stretch(reader, made.run.run);
    if (!stretch) return stretch.error();
    auto terms = read_noise_terms(reader, made.run, *stretch);
    if (!terms) return terms.error();
    if (*terms && (!longest || (*terms)->samples > longest->samples)) longest = std::move(*terms);
  }
  return longest;
}

/// The run's tests and noise; `several` runs have their number in the tests' names.
Status add_run(record::RunLogReader& reader, std::int64_t number, bool several,
               const AcceptanceOptions& options, Acceptance& out) {
  const auto points = record::valid_points(reader, number, options.unfinished);
  if (!points) return points.error();
  const std::size_t first = out.runs.size();
  if (const Status added = add_provenance(reader, number, out); !added) return added;
  const auto name_of = [&](int test) {
    return several ? fmt::format("{}/{}", number, test) : std::to_string(test);
  };
  std::vector<Point> of_test;
  for (std::size_t i = 0; i < points->size(); ++i) {
    of_test.push_back((*points)[i]);
    if (i + 1 < points->size() && (*points)[i + 1].test == of_test.front().test) continue;
    auto test = results_of(of_test, options);
    if (!test) return test.error();
    test->name = name_of(of_test.front().test);
    test->run = number;
    if (const Status added = add_measured(*test, of_test, out.measured); !added) return added;
    out.tests.push_back(std::move(*test));
    of_test.clear();
  }
  const auto terms = longest_noise(reader, std::span(out.runs).subspan(first));
  if (!terms) return terms.error();
  if (*terms) {
    out.noise.push_back(**terms);
    add_measured(**terms, name_of((*terms)->stretch.test), *points, out.measured);
  }
  return {};
}

}  // namespace

Result<Acceptance> gather_acceptance(record::RunLogReader& reader,
                                     const std::vector<std::int64_t>& runs,
                                     const AcceptanceOptions& options) {
  Acceptance out;
  for (const std::int64_t number : runs) {
    const bool twice = std::any_of(out.runs.begin(), out.runs.end(),
                                   [number](const auto& made) { return made.run.run == number; });
    if (twice) {
      return Error{ErrorCode::kBadInput,
                   fmt::format("run {} is named twice, once was expected", number)};
    }
    const Status added = add_run(reader, number, runs.size() > 1, options, out);
    if (!added) return added.error();
  }
  out.changes = changes_of(out.tests);
  return out;
}

}  // namespace fogbench::acceptance
