#include "model/diagnose/sensitivities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "config/channels.hpp"
#include "model/effects/catalogue.hpp"
#include "model/effects/sensitivity.hpp"
#include "model/table/median.hpp"
#include "model/table/moving_signals.hpp"

namespace fogbench::model {
namespace {

using effects::SensitivityForm;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Each column is several candidates; a log of a hundred channels is for the user to choose from.
constexpr std::size_t kMostColumns = 12;
// A lag of less than this many rows is no lag in these data.
constexpr double kLeastLag = 2.0;
constexpr int kLags = 12;

/// What a model file can name between the brackets of sensitivity().
bool can_be_named(std::string_view column) {
  return std::all_of(column.begin(), column.end(), [](unsigned char c) {
    return c == '_' || (c < 0x80 && std::isalnum(c) != 0);
  });
}

double usual_step_s(const Signals& signals) {
  const auto time = signals.signal("time_s");
  std::vector<double> steps;
  for (const Signals::RunRange& run : signals.runs()) {
    for (std::size_t i = run.begin + 1; i < run.end; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      steps.push_back(time[row] - time[row - 1]);
    }
  }
  return steps.empty() ? 0.0 : median(std::move(steps));
}

bool takes_three_levels(const MovingSignal& x) {
  std::set<long> levels;
  for (const double v : x.scaled) levels.insert(std::lround(10.0 * v));
  return levels.size() >= 3;
}

/// The generic forms are for causes that the catalogue does not know.
bool is_in_catalogue(const std::string& column) {
  const auto effects = catalogue();
  return std::any_of(effects.begin(), effects.end(), [&](const Effect* effect) {
    const auto& signals = effect->info().signals;
    return std::find(signals.begin(), signals.end(), column) != signals.end();
  });
}

class CausesOf {
 public:
  CausesOf(LibraryBuilder& builder, const MovingSignal& x)
      : builder_(builder), x_(x), value_(x.value) {
    // The model's bias takes up the mean; without it products would be nothing but their other
    // factor.
    if (stands_in_model("bias")) value_.array() -= x.value.mean();
  }

  void add_all() {
    for (const SensitivityForm& form : effects::kSensitivityForms) {
      const std::string id = effects::sensitivity_of(form, x_.name);
      if (!stands_in_model(id) && can_show(form)) add(form, id);
    }
  }

 private:
  bool stands_in_model(std::string_view effect) const {
    const auto& terms = builder_.source().model.terms;
    return std::any_of(terms.begin(), terms.end(),
                       [&](const config::ModelTerm& term) { return term.effect == effect; });
  }

  bool can_show(const SensitivityForm& form) const {
    const Signals& signals = builder_.signals();
    if (form.name == "sensitivity_quadratic") return takes_three_levels(x_);
    if (form.with.empty()) return true;
    if (form.with == "time_s") return signals.available("time_s");
    return moving_signal(signals, form.with, least_excitation(form.with)).has_value();
  }

  void add(const SensitivityForm& form, const std::string& id) {
    const EffectInfo& info = find_effect(id)->info();
    Candidate candidate{.name = id, .kind = Candidate::Kind::kEffect};
    candidate.units.assign(info.units.begin(), info.units.end());
    std::string beside(form.beside);
    if (beside == "sensitivity(x)") {
      beside = effects::sensitivity_of(effects::kSensitivityForms.front(), x_.name);
    }
    if (!beside.empty() && !stands_in_model(beside)) candidate.terms.push_back({.effect = beside});
    candidate.terms.push_back({.effect = id});
    std::vector<double> grid{0.0};
    if (!info.parameters.empty()) {
      candidate.parameter = info.parameters.front();
      candidate.extends = effects::sensitivity_of(effects::kSensitivityForms.front(), x_.name);
      grid = lags(*candidate.parameter);
    }
    candidate.shapes.push_back([&form, value = value_, source = builder_.source()](double tau_s) {
      const MatrixXd starts = effects::sensitivity_starts(form, source.signals, value, tau_s);
      MatrixXd out(value.size(), 1 + starts.cols());
      out << effects::sensitivity_values(form, source.signals, value, tau_s), starts;
      return LibraryBuilder(source).averaged(std::move(out));
    });
    builder_.add_on_grid(std::move(candidate), grid);
  }

  std::vector<double> lags(const InnerParameter& tau) const {
    const double least =
        std::clamp(kLeastLag * usual_step_s(builder_.signals()), tau.minimum, 0.25 * tau.maximum);
    std::vector<double> out;
    for (int i = 0; i < kLags; ++i) {
      out.push_back(least * std::pow(tau.maximum / least, static_cast<double>(i) / (kLags - 1)));
    }
    return out;
  }

  LibraryBuilder& builder_;
  const MovingSignal& x_;
  VectorXd value_;
};

}  // namespace

void add_sensitivities(LibraryBuilder& builder) {
  const Signals& signals = builder.signals();
  std::size_t tried = 0;
  for (const std::string& name : signals.table().column_names()) {
    if (config::is_point_channel(name) || is_made_for_analysis(name) || is_in_catalogue(name) ||
        name == builder.source().model.observable) {
      continue;
    }
    const std::string id = effects::sensitivity_of(effects::kSensitivityForms.front(), name);
    const auto moving = moving_signal(signals, name);
    if (!can_be_named(name)) {
      builder.refuse(id, "a column's name needs to be of letters, digits and underscores");
    } else if (!moving) {
      builder.refuse(id, name + " stays at one value");
    } else if (tried == kMostColumns) {
      builder.refuse(id, fmt::format("at most {} further columns are tried", kMostColumns));
    } else {
      CausesOf(builder, *moving).add_all();
      ++tried;
    }
  }
}

}  // namespace fogbench::model
