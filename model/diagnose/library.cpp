#include "model/diagnose/library.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "model/diagnose/library_builder.hpp"
#include "model/diagnose/sensitivities.hpp"
#include "model/diagnose/shadows.hpp"
#include "model/effects/catalogue.hpp"
#include "model/effects/excitation.hpp"
#include "model/effects/expression.hpp"
#include "model/table/moving_signals.hpp"

namespace fogbench::model {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kGridPoints = 20;       // of an inner parameter
constexpr int kMostJumpPlaces = 400;  // of an instant
// A change that lasts from one run on is a candidate for each run; with many of them every scatter
// between runs looks like one. A bias of each run is one candidate of many columns.
constexpr std::size_t kMostRunsOneByOne = 8, kMostRuns = 40;
// A user's inner parameter is looked for within this factor of the value that he gave.
constexpr double kUsersRange = 5.0;
constexpr double kRipplePeriods = 1.2;  // fewer inside the range look like a polynomial

/// Instants at which a jump can be told from its neighbours: the middles between rows.
std::vector<double> jump_places(const Signals& signals) {
  std::vector<double> out;
  const auto time = signals.signal("time_s");
  for (const Signals::RunRange& run : signals.runs()) {
    for (std::size_t i = run.begin + 2; i + 1 < run.end; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      out.push_back(0.5 * (time[k - 1] + time[k]));
    }
  }
  std::sort(out.begin(), out.end());
  const std::size_t step = out.size() / kMostJumpPlaces + 1;
  std::vector<double> thinned;
  for (std::size_t i = 0; i < out.size(); i += step) thinned.push_back(out[i]);
  return thinned;
}

std::vector<double> grid_of(const InnerParameter& parameter, const Signals& signals) {
  if (parameter.instant) return jump_places(signals);
  double least = parameter.minimum, most = parameter.maximum;
  int points = kGridPoints;
  if (!parameter.period_of.empty()) {
    const auto t = moving_signal(signals, parameter.period_of);
    if (t) most = std::min(most, t->span() / kRipplePeriods);
    if (most <= least) return {};
    points *= 2;
  }
  std::vector<double> out;
  for (int i = 0; i < points; ++i) {
    const double share = static_cast<double>(i) / (points - 1);
    out.push_back(parameter.logarithmic && least > 0.0 ? least * std::pow(most / least, share)
                                                       : least + share * (most - least));
  }
  return out;
}

void add_grid(LibraryBuilder& builder, Candidate candidate) {
  const std::vector<double> grid = candidate.parameter
                                       ? grid_of(*candidate.parameter, builder.signals())
                                       : std::vector<double>{0.0};
  builder.add_on_grid(std::move(candidate), grid);
}

void add_effect(LibraryBuilder& builder, const Effect& effect) {
  const Signals& signals = builder.signals();
  const EffectInfo& info = effect.info();
  const std::string& id = info.id;
  if (const auto missing = signals.missing_for(info); !missing.empty()) {
    return builder.refuse(id, fmt::format("the table has no {}", fmt::join(missing, ", ")));
  }
  if (std::string because = unexcited_because(info, signals); !because.empty()) {
    return builder.refuse(id, std::move(because));
  }
  Candidate candidate{.name = id,
                      .kind = Candidate::Kind::kEffect,
                      .own = static_cast<Eigen::Index>(info.columns.size()),
                      .slow = info.slow};
  candidate.terms.push_back({.effect = id});
  candidate.limit = info.limit;
  candidate.units.assign(info.units.begin(), info.units.end());
  const auto is_time = [](std::string_view name) {
    return name == "time_s" || name == "time_since_power_on_s";
  };
  if (info.signals.size() == 1 && !info.has_history && !is_time(info.signals.front())) {
    candidate.curve_over = info.signals.front();
  }
  if (!info.parameters.empty()) candidate.parameter = info.parameters.front();
  std::vector<Shape> shapes;
  const auto& forms = builder.source().forms;
  const auto form = std::find_if(forms.begin(), forms.end(), [&](const config::ModelTerm& term) {
    return find_effect(term.effect)->info().form_of == info.id;
  });
  if (form == forms.end()) {
    shapes = shapes_of(effect, signals);
  } else {
    const Effect& other = *find_effect(form->effect);
    std::vector<double> further;
    for (std::size_t i = 1; i < other.info().parameters.size(); ++i) {
      further.push_back(form->parameters.at(std::string(other.info().parameters[i].name)));
    }
    shapes = shapes_of_form(other, signals, further);
    candidate.terms = {*form};
    candidate.parameter = other.info().parameters.front();
    candidate.own = static_cast<Eigen::Index>(other.info().columns.size());
    candidate.units.assign(other.info().units.begin(), other.info().units.end());
  }
  for (Shape& shape : shapes) {
    candidate.shapes.push_back([shape = std::move(shape), source = builder.source()](double inner) {
      return LibraryBuilder(source).averaged(shape(inner));
    });
  }
  add_grid(builder, std::move(candidate));
}

/// A formula of the user's; its first inner parameter is looked for around the given value.
Status add_expression(LibraryBuilder& builder, const config::ModelTerm& term) {
  const Signals& signals = builder.signals();
  std::set<std::string> names;
  for (const auto& [name, value] : term.parameters) names.insert(name);
  auto expression = Expression::parse(term.effect, *term.expression, names, signals);
  if (!expression) return expression.error();
  for (const std::string& name : expression->signals()) {
    if (!signals.available(name)) {
      builder.refuse(term.effect, fmt::format("the table has no {}", name));
      return {};
    }
  }
  Candidate candidate{.name = term.effect, .kind = Candidate::Kind::kEffect, .terms = {term}};
  candidate.units.push_back(term.unit);
  const auto& used = expression->parameters();
  std::vector<double> values;
  for (const std::string& name : used) values.push_back(term.parameters.at(name));
  if (!values.empty() && values.front() > 0.0) {
    candidate.parameter_name = used.front();
    candidate.parameter = InnerParameter{.name = {},
                                         .unit = {},
                                         .minimum = values.front() / kUsersRange,
                                         .maximum = values.front() * kUsersRange};
  }
  candidate.shapes.push_back(
      [expression = *expression, values, source = builder.source(), &signals](double inner) {
        std::vector<double> at = values;
        if (!at.empty() && at.front() > 0.0) at.front() = inner;
        return LibraryBuilder(source).averaged(expression.evaluate(signals, at));
      });
  add_grid(builder, std::move(candidate));
  return {};
}

/// Expressions that enter together, as one candidate. Nothing is added without any.
Status add_together(LibraryBuilder& builder, Candidate candidate) {
  std::vector<Expression> expressions;
  for (const config::ModelTerm& term : candidate.terms) {
    auto expression = Expression::parse(term.effect, *term.expression, {}, builder.signals());
    if (!expression) return expression.error();
    expressions.push_back(*expression);
    candidate.units.push_back(term.unit);
  }
  if (expressions.empty()) return {};
  candidate.own = static_cast<Eigen::Index>(expressions.size());
  candidate.shapes.push_back(
      [expressions, source = builder.source(), &signals = builder.signals()](double) {
        MatrixXd out(static_cast<Eigen::Index>(signals.rows()),
                     static_cast<Eigen::Index>(expressions.size()));
        for (std::size_t i = 0; i < expressions.size(); ++i) {
          out.col(static_cast<Eigen::Index>(i)) = expressions[i].evaluate(signals, {});
        }
        return LibraryBuilder(source).averaged(std::move(out));
      });
  add_grid(builder, std::move(candidate));
  return {};
}

/// What may have changed from one run to the next: the bias, and the magnetic sensitivity (the
/// shield's history, or the coils' calibration). A change may last from one run on; and the bias of
/// a gyro is another one each time it is switched on, which is one candidate for all runs.
Status add_changes_between_runs(LibraryBuilder& builder) {
  const Signals& signals = builder.signals();
  const std::size_t runs =
      signals.runs().size() - (builder.source().table.has_quiet_record() ? 1 : 0);
  if (runs < 2) return {};
  const std::string name = "bias_change_between_runs";
  if (runs > kMostRuns) {
    builder.refuse(name, fmt::format("the table has {} runs; a bias of each is looked for among at "
                                     "most {}",
                                     runs, kMostRuns));
    return {};
  }
  if (runs > 2) {
    Candidate each{.name = name, .kind = Candidate::Kind::kEffect};
    for (std::size_t run = 1; run < runs; ++run) {
      each.terms.push_back({.effect = fmt::format("{}_{}", name, run + 1),
                            .expression = fmt::format("(run_index == {})", run),
                            .unit = "deg/h"});
    }
    if (Status added = add_together(builder, std::move(each)); !added) return added;
  }
  if (runs > kMostRunsOneByOne) return {};
  for (std::size_t run = 1; run < runs; ++run) {
    const std::string suffix = runs > 2 ? fmt::format("_from_{}", run + 1) : std::string();
    const auto since = [&](const std::string& what) {
      return fmt::format("(run_index >= {}){}", run, what);
    };
    Candidate magnetic{.name = "magnetic_change_between_runs" + suffix,
                       .kind = Candidate::Kind::kEffect};
    for (const config::ModelTerm& term : builder.source().model.terms) {
      if (!is_field_sensitivity(term.effect)) continue;
      const std::string& field = find_effect(term.effect)->info().signals.front();
      magnetic.terms.push_back({.effect = fmt::format("{}_change{}", term.effect, suffix),
                                .expression = since(fmt::format(" * {} / 100", field)),
                                .unit = "deg/h per 100 uT"});
    }
    Candidate bias{.name = name + suffix, .kind = Candidate::Kind::kEffect};
    bias.terms.push_back({.effect = bias.name, .expression = since(""), .unit = "deg/h"});
    for (Candidate* candidate : {&bias, &magnetic}) {
      if (Status added = add_together(builder, std::move(*candidate)); !added) return added;
    }
  }
  return {};
}

}  // namespace

double Candidate::spacing(double inner) const {
  double below = -std::numeric_limits<double>::infinity(), above = -below;
  for (const Block& block : blocks) {
    if (block.inner < inner) below = std::max(below, block.inner);
    if (block.inner > inner) above = std::min(above, block.inner);
  }
  if (std::isinf(below)) return std::isinf(above) ? 0.0 : above - inner;
  return std::isinf(above) ? inner - below : 0.5 * (above - below);
}

Eigen::Index Library::columns_of(bool effects_alone) const {
  if (!effects_alone) return columns.cols();
  Eigen::Index end = 0;
  for (const Candidate& candidate : candidates) {
    if (candidate.shadow()) continue;
    for (const Block& block : candidate.blocks) end = std::max(end, block.first + block.width);
  }
  return end;
}

Result<Library> make_library(const LibrarySource& source) {
  LibraryBuilder builder(source);
  const auto stands_in = [&](std::string_view effect) {
    return std::any_of(
        source.model.terms.begin(), source.model.terms.end(), [&](const config::ModelTerm& term) {
          const Effect* known = find_effect(term.effect);
          return term.effect == effect || (known != nullptr && known->info().form_of == effect);
        });
  };
  for (const Effect* effect : catalogue()) {
    if (!stands_in(effect->info().id)) add_effect(builder, *effect);
  }
  for (const config::ModelTerm& term : source.users_terms) {
    if (stands_in(term.effect)) continue;
    if (!term.expression) {
      if (find_effect(term.effect) == nullptr) {
        return Error{ErrorCode::kBadInput, unknown_effect(term.effect)};
      }
      continue;  // a candidate anyway
    }
    if (Status added = add_expression(builder, term); !added) return added.error();
  }
  add_sensitivities(builder);
  if (Status added = add_changes_between_runs(builder); !added) return added.error();
  add_shadows(builder);
  return builder.finish();
}

}  // namespace fogbench::model
