#include "model/compare/conformity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/table/table.hpp"

namespace fogbench::model {
namespace {

bool is_measured(const Measured& m) {
  return std::isfinite(m.value) && std::isfinite(m.standard_error);
}

/// The results of one quantity, in the order of the tests.
std::vector<const Measured*> all_of(const std::vector<Measured>& measured,
                                    const std::string& quantity) {
  std::vector<const Measured*> out;
  for (const Measured& m : measured) {
    if (m.quantity == quantity) out.push_back(&m);
  }
  return out;
}

Status check_unit(const config::Limit& limit, const Measured& m, const std::string& name) {
  if (limit.unit.empty() || limit.unit == m.unit) return {};
  return Error{ErrorCode::kBadInput,
               fmt::format("limits {}: {} is limited in \"{}\"; the results have it in \"{}\"",
                           name, limit.quantity, limit.unit, m.unit)};
}

void add_repeats(Judged& judged, const std::vector<const Measured*>& results,
                 std::optional<double> limit) {
  const Measured* before = nullptr;
  for (const Measured* m : results) {
    if (!is_measured(*m)) continue;
    if (before != nullptr) {
      Repeat repeat{
          .quantity = m->quantity,
          .unit = m->unit,
          .test_a = before->test,
          .test_b = m->test,
          .value_a = before->value,
          .value_b = m->value,
          .difference = m->value - before->value,
          .expanded_uncertainty = std::hypot(expanded_uncertainty(*before, judged.coverage_factor),
                                             expanded_uncertainty(*m, judged.coverage_factor)),
          .limit = limit};
      repeat.significant = std::abs(repeat.difference) > repeat.expanded_uncertainty;
      if (limit) {
        repeat.verdict = judge(repeat.difference, repeat.expanded_uncertainty, -*limit, *limit);
      }
      judged.repeats.push_back(std::move(repeat));
    }
    before = m;
  }
}

/// The judgement of one limit, test by test; a row of its own when too few tests hold the quantity.
void add_results(Judged& judged, const config::Limit& limit, int tests_expected,
                 const std::vector<const Measured*>& results) {
  Judgement row{.quantity = limit.quantity,
                .unit = limit.unit,
                .value = kMissing,
                .expanded_uncertainty = kMissing,
                .minimum = limit.minimum,
                .maximum = limit.maximum,
                .tests_expected = tests_expected};
  row.tests_measured = static_cast<int>(std::count_if(
      results.begin(), results.end(), [](const Measured* m) { return is_measured(*m); }));
  for (const Measured* m : results) {
    Judgement of_test = row;
    of_test.test = m->test;
    of_test.unit = m->unit;
    of_test.conditions = m->conditions;
    of_test.value = m->value;
    of_test.expanded_uncertainty = expanded_uncertainty(*m, judged.coverage_factor);
    const bool limited = limit.minimum || limit.maximum;
    // A repeatability alone asks only that the quantity is there.
    of_test.verdict =
        limited ? judge(of_test.value, of_test.expanded_uncertainty, limit.minimum, limit.maximum)
        : is_measured(*m) ? Conformity::kPass
                          : Conformity::kIndeterminate;
    judged.results.push_back(std::move(of_test));
  }
  if (row.tests_measured < tests_expected) judged.results.push_back(std::move(row));
}

}  // namespace

std::string_view name_of(Conformity verdict) {
  switch (verdict) {
    case Conformity::kPass:
      return "pass";
    case Conformity::kFail:
      return "fail";
    case Conformity::kIndeterminate:
      break;
  }
  return "indeterminate";
}

double expanded_uncertainty(const Measured& measured, double coverage_factor) {
  return 0.5 * measured.coverage_factor * coverage_factor * measured.standard_error;
}

Conformity judge(double value, double expanded_uncertainty, std::optional<double> minimum,
                 std::optional<double> maximum) {
  const double low = value - expanded_uncertainty, high = value + expanded_uncertainty;
  if (std::isnan(low) || std::isnan(high)) return Conformity::kIndeterminate;
  if ((minimum && high < *minimum) || (maximum && low > *maximum)) return Conformity::kFail;
  if ((minimum && low < *minimum) || (maximum && high > *maximum))
    return Conformity::kIndeterminate;
  return Conformity::kPass;
}

Conformity worst_of(Conformity a, Conformity b) {
  if (a == Conformity::kFail || b == Conformity::kFail) return Conformity::kFail;
  return a == Conformity::kPass ? b : a;
}

Result<Judged> judge_results(const std::vector<Measured>& measured,
                             const config::LimitsConfig& limits) {
  Judged judged{.overall = Conformity::kPass, .coverage_factor = limits.coverage_factor};
  std::vector<std::string> seen;
  for (const config::Limit& limit : limits.limits) {
    const auto results = all_of(measured, limit.quantity);
    for (const Measured* m : results) {
      if (const Status unit = check_unit(limit, *m, limits.name); !unit) return unit.error();
    }
    add_results(judged, limit, limit.tests.value_or(limits.tests), results);
    const std::size_t before = judged.repeats.size();
    add_repeats(judged, results, limit.repeatability);
    // A repeatability that was never measured is not kept.
    if (limit.repeatability && judged.repeats.size() == before) {
      judged.repeats.push_back({.quantity = limit.quantity,
                                .unit = limit.unit,
                                .value_a = kMissing,
                                .value_b = kMissing,
                                .difference = kMissing,
                                .expanded_uncertainty = kMissing,
                                .limit = limit.repeatability,
                                .verdict = Conformity::kIndeterminate});
    }
    seen.push_back(limit.quantity);
  }
  for (const Measured& m : measured) {
    if (std::find(seen.begin(), seen.end(), m.quantity) != seen.end()) continue;
    seen.push_back(m.quantity);
    add_repeats(judged, all_of(measured, m.quantity), {});
  }
  for (const Judgement& row : judged.results)
    judged.overall = worst_of(judged.overall, row.verdict);
  for (const Repeat& row : judged.repeats) {
    if (row.verdict) judged.overall = worst_of(judged.overall, *row.verdict);
  }
  return judged;
}

}  // namespace fogbench::model
