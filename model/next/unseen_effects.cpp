#include "model/next/unseen_effects.hpp"
#include "model/effects/excitation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/effects/catalogue.hpp"
#include "model/next/separation.hpp"
#include "model/next/set_choice.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// An experiment that shows an effect this much less well than the best one still shows it.
constexpr double kShowsAsWell = 0.2;
constexpr int kCoarseGridPoints = 4;
constexpr std::size_t kMostNamed = 4;  // in one line; the rest is counted

/// The instrument that a column comes from, for people.
std::string_view source_of(std::string_view column) {
  if (column.starts_with("field_") || column == "coil_current_a") {
    return "of the magnetometer or the coil supplies";
  }
  if (column == "azimuth_deg") return "of the turntable, or set by hand";
  if (column == "ambient_c") return "of a thermometer in the room";
  if (column == "time_s") return "of the clock, since power-on";
  return "of the thermostat";
}

/// |z|^2 of each effect in each experiment, at the least visible of its inner parameters.
MatrixXd visibility(const NextMeasurementInput& input, const Recorded& present,
                    const std::vector<Experiment>& experiments,
                    const std::vector<const Effect*>& effects) {
  const auto count = static_cast<Index>(effects.size());
  MatrixXd shown = MatrixXd::Zero(static_cast<Index>(experiments.size()), count);
  if (effects.empty()) return shown;
  const Separation separation(present, input.fitted, effects,
                              std::vector<std::vector<double>>(effects.size()), input.noise,
                              kCoarseGridPoints);
  if (separation.present().size() == 0) return shown;
  for (std::size_t e = 0; e < experiments.size(); ++e) {
    const Recorded& record = experiments[e].record;
    const Signals there(record.table, input.fitted.reference_temperature_c);
    const MatrixXd gram = separation.with(record);
    for (std::size_t i = 0; i < effects.size(); ++i) {
      if (!unexcited_because(effects[i]->info(), there).empty()) continue;
      double least = std::numeric_limits<double>::infinity();
      for (const GramBlock& b : separation.members()[i].blocks) {
        const double z2 = gram.block(b.first, b.first, b.width, b.width).trace();
        least = std::min(least, z2 / static_cast<double>(b.width));
      }
      shown(static_cast<Index>(e), static_cast<Index>(i)) = least;
    }
  }
  return shown;
}

}  // namespace

std::vector<NextMeasurement> columns_to_record(const NextMeasurementInput& input) {
  const Signals signals(input.present, input.fitted.reference_temperature_c);
  struct Group {
    std::string_view source;
    std::vector<std::string> columns, effects;
  };
  std::vector<Group> groups;
  for (const NotTestable& entry : input.not_testable) {
    const Effect* effect = find_effect(entry.effect);
    if (effect == nullptr) continue;
    const auto missing = signals.missing_for(effect->info());
    if (missing.empty()) continue;
    const std::string_view source = source_of(missing.front());
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const Group& g) { return g.source == source; });
    if (group == groups.end()) group = groups.insert(groups.end(), {source, {}, {}});
    group->effects.push_back(entry.effect);
    for (const std::string& column : missing) {
      auto& columns = group->columns;
      if (std::find(columns.begin(), columns.end(), column) == columns.end()) {
        columns.push_back(column);
      }
    }
  }
  std::vector<NextMeasurement> out;
  for (Group& g : groups) {
    out.push_back({.tells_apart = std::move(g.effects),
                   .action = fmt::format("record {} ({})", fmt::join(g.columns, ", "), g.source),
                   .purpose = NextMeasurement::Purpose::kShow});
  }
  return out;
}

std::vector<NextMeasurement> experiments_for_unseen(const NextMeasurementInput& input,
                                                    const Recorded& present,
                                                    const std::vector<Experiment>& experiments) {
  const Signals signals(input.present, input.fitted.reference_temperature_c);
  // Elementary effects first: the others have to show beside them, they not beside each other.
  std::vector<const Effect*> effects, others;
  for (const NotTestable& entry : input.not_testable) {
    const Effect* effect = find_effect(entry.effect);
    if (effect == nullptr || !signals.missing_for(effect->info()).empty()) continue;
    (effect->info().elementary_in.empty() ? others : effects).push_back(effect);
  }
  MatrixXd shown(static_cast<Index>(experiments.size()),
                 static_cast<Index>(effects.size() + others.size()));
  shown << visibility(input, present, experiments, effects),
      visibility(input, present, experiments, others);
  effects.insert(effects.end(), others.begin(), others.end());
  std::vector<NextMeasurement> out;
  if (effects.empty()) return out;
  const VectorXd hours = [&] {
    VectorXd h(shown.rows());
    for (Index e = 0; e < h.size(); ++e)
      h[e] = experiments[static_cast<std::size_t>(e)].record.hours;
    return h;
  }();
  const MatrixXd per_hour = hours.cwiseInverse().asDiagonal() * shown;
  const VectorXd best = per_hour.colwise().maxCoeff();

  std::vector<bool> open(effects.size());
  for (std::size_t i = 0; i < open.size(); ++i) open[i] = best[static_cast<Index>(i)] > 0.0;
  while (std::any_of(open.begin(), open.end(), [](bool o) { return o; })) {
    std::vector<std::size_t> covered;
    Index chosen = 0;
    for (Index e = 0; e < shown.rows(); ++e) {
      std::vector<std::size_t> covers;
      for (std::size_t i = 0; i < open.size(); ++i) {
        const auto k = static_cast<Index>(i);
        if (open[i] && per_hour(e, k) >= kShowsAsWell * best[k]) covers.push_back(i);
      }
      if (covers.size() > covered.size()) {
        covered = std::move(covers);
        chosen = e;
      }
    }
    const Experiment& best_one = experiments[static_cast<std::size_t>(chosen)];
    NextMeasurement next{.tells_apart = {},
                         .action = {},
                         .hours = hours[chosen],
                         .purpose = NextMeasurement::Purpose::kShow,
                         .experiment = best_one.key};
    std::vector<std::string> from;
    for (const std::size_t i : covered) {
      open[i] = false;
      const EffectInfo& info = effects[i]->info();
      next.tells_apart.emplace_back(info.id);
      const double z = std::sqrt(shown(chosen, static_cast<Index>(i)));
      from.push_back(fmt::format("{} from {:.2g} {}", info.id, kSeparates / z, info.units.front()));
    }
    std::string rest;
    if (from.size() > kMostNamed) {
      rest = fmt::format(" and {} more effects", from.size() - kMostNamed);
      from.resize(kMostNamed);
    }
    next.action = fmt::format("{}: would show {}{} ({:.1f} h)", best_one.action,
                              fmt::join(from, ", "), rest, next.hours);
    out.push_back(std::move(next));
  }
  return out;
}

}  // namespace fogbench::model
