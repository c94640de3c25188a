#include "model/next/set_choice.hpp"
#include "model/effects/excitation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "model/diagnose/present_run.hpp"
#include "model/effects/catalogue.hpp"
#include "model/table/signals.hpp"

namespace fogbench::model {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr const char* kRandomWalk = "random_walk";
// Aimed at, so that nineteen measurements in twenty come out above kSeparates.
constexpr double kAim = kSeparates + 1.645;
// More repetitions than this are no recommendation.
constexpr int kMostTimes = 6;
constexpr double kMostPresentTimes = 100.0;
// A second way is mentioned when it takes at most this much more time.
constexpr double kNearlyAsQuick = 1.5;
// What no ready procedure does alone takes an operator, or longer: it has to be this much quicker.
constexpr double kByHand = 1.5;
// Walks that a rival may be, in shares of the variance of the walk that scatters like the effect.
constexpr std::array<double, 6> kWalks = {0.0, 0.03, 0.1, 0.3, 1.0, 3.0};
constexpr int kFineGridPoints = 30;

/// Does an effect with a memory move in a run that the diagnosis would not test it in (a thermal
/// hysteresis without a cooling branch, say)? Its state there is a guess, and what tells effects
/// apart by it is not to be trusted.
bool misleading(const Effect& effect, const std::vector<double>& inner, const Recorded& record,
                double reference_temperature_c) {
  if (!effect.info().has_history) return false;
  const Signals signals(record.table, reference_temperature_c);
  if (unexcited_because(effect.info(), signals).empty()) return false;
  const MatrixXd columns = effect.regressor(signals, inner);
  return (columns.rowwise() - columns.row(0)).cwiseAbs().maxCoeff() > 0.0;
}

}  // namespace

SetChoice::SetChoice(const NextMeasurementInput& input, const Recorded& present,
                     const std::vector<Experiment>& experiments,
                     const std::vector<std::string>& set)
    : input_(input), present_(present) {
  for (const std::string& name : set) {
    if (name == kRandomWalk) walk_ = true;
    const Effect* effect = find_effect(name);
    if (effect == nullptr || std::find(effects_.begin(), effects_.end(), effect) != effects_.end())
      continue;
    effects_.push_back(effect);
    names_.push_back(name);
  }
  if (names_.empty() || names_.front() != set.front() || (names_.size() < 2 && !walk_)) return;
  if (!find_leader()) return;
  if (walk_) names_.emplace_back(kRandomWalk);
  weigh(experiments);
}

bool SetChoice::find_leader() {
  const EffectInfo& info = effects_.front()->info();
  for (const config::ModelTerm& term : input_.fitted.terms) {
    if (term.expression || term.effect != info.id) continue;
    leader_.beta.resize(static_cast<Index>(info.columns.size()));
    for (std::size_t i = 0; i < info.columns.size(); ++i) {
      const auto key = term.coefficients.find(std::string(info.columns[i]));
      if (key == term.coefficients.end() && !term.coefficient) return false;
      leader_.beta[static_cast<Index>(i)] =
          key != term.coefficients.end() ? key->second : *term.coefficient;
    }
    for (const InnerParameter& parameter : info.parameters) {
      const auto value = term.parameters.find(std::string(parameter.name));
      if (value == term.parameters.end()) return false;
      leader_inner_.push_back(value->second);
    }
    return true;
  }
  return false;
}

/// K^2 of the walk whose scatter about its own mean, K^2 T/6 over a run of T, is that of the
/// effect.
double SetChoice::mimicking_walk_squared(const Separation& separation) const {
  const VectorXd effect = separation.present_columns(0, 0) * leader_.beta;
  const Windows& w = present_.windows;
  double squares = 0.0;
  for (std::size_t run = 0; run + 1 < w.run_begin.size(); ++run) {
    const auto first = static_cast<Index>(w.run_begin[run]);
    const auto part =
        effect.segment(first, static_cast<Index>(w.run_begin[run + 1]) - first).array();
    squares += (part - part.mean()).square().sum();
  }
  const double run_hours = span_h(present_) / static_cast<double>(w.run_begin.size() - 1);
  return run_hours > 0.0 ? 6.0 * squares / static_cast<double>(effect.size()) / run_hours : 0.0;
}

/// Every member as the truth, each as plain in the present data as the leader is, and with the
/// inner parameter that looks most like it: so would they have to be to have been found.
void SetChoice::find_truths(const Separation& separation) {
  const MatrixXd& gram = separation.present();
  const double plain = separation.squared(gram, 0, leader_);
  for (std::size_t a = 0; a < effects_.size(); ++a) {
    Truth truth = a == 0 ? leader_ : separation.nearest(gram, 0, leader_, a);
    const double shown = separation.squared(gram, a, truth);
    if (shown > 1e-12 * plain) truth.beta *= std::sqrt(plain / shown);
    truths_.push_back({truth});
    const auto& blocks = separation.members()[a].blocks;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const bool same_jump = blocks[i].inner == blocks[truth.block].inner &&
                             blocks[i].once != blocks[truth.block].once;
      if (same_jump) truths_.back().push_back({i, truth.beta});
    }
  }
}

/// s^2 of each truth against each rival over the present data and, if any, one more run.
MatrixXd SetChoice::squared(const Separation& separation, const std::vector<Walk>& walks,
                            const Recorded* more) const {
  const MatrixXd gram = more != nullptr ? separation.with(*more) : separation.present();
  const auto count = static_cast<Index>(names_.size());
  MatrixXd out = MatrixXd::Constant(count, count, std::numeric_limits<double>::infinity());
  for (std::size_t a = 0; a < effects_.size(); ++a) {
    for (std::size_t b = 0; b < effects_.size(); ++b) {
      if (a == b) continue;
      double& least = out(static_cast<Index>(a), static_cast<Index>(b));
      for (const Truth& truth : truths_[a]) {
        least = std::min(least, separation.squared(gram, a, truth, b));
      }
    }
  }
  for (const Walk& walk : walks) {
    const MatrixXd walk_gram =
        more != nullptr ? walk.separation.with(*more) : walk.separation.present();
    double noise = walk.present_squared;
    if (more != nullptr) noise += squared_noise_separation(span_h(*more), input_.noise, walk.noise);
    for (std::size_t a = 0; a < effects_.size(); ++a) {
      double& least = out(static_cast<Index>(a), count - 1);
      for (std::size_t i = 0; i < truths_[a].size(); ++i) {
        // Blocks without a grid stand in the order of the truths: again, once.
        const Truth truth{i, truths_[a][i].beta};
        least = std::min(least, noise + walk.separation.squared(walk_gram, a, truth));
      }
    }
  }
  return out;
}

void SetChoice::weigh(const std::vector<Experiment>& experiments) {
  std::vector<std::vector<double>> inner(effects_.size());
  inner.front() = leader_inner_;
  const Separation separation(present_, input_.fitted, effects_, inner, input_.noise,
                              kFineGridPoints);
  if (separation.present().size() == 0) return;
  find_truths(separation);
  std::vector<Walk> walks;
  if (walk_) {
    // Only the truths stand against a walk, and no grid is needed.
    for (std::size_t a = 0; a < effects_.size(); ++a) {
      inner[a] = separation.members()[a].blocks[truths_[a].front().block].inner;
    }
    const double squared = mimicking_walk_squared(separation);
    for (const double share : kWalks) {
      NoiseCoefficients noise = input_.noise;
      double& k = noise.rate_random_walk_deg_per_h_per_sqrt_h;
      k = std::sqrt(k * k + share * squared);
      walks.push_back({noise, Separation(present_, input_.fitted, effects_, inner, noise, 0),
                       squared_noise_separation(span_h(present_), input_.noise, noise)});
    }
  }
  present_squared_ = squared(separation, walks, nullptr);
  for (const Experiment& experiment : experiments) {
    if (!concerns(experiment)) continue;
    bool trusted = true;
    for (std::size_t a = 0; a < effects_.size(); ++a) {
      const std::size_t block = truths_[a].front().block;
      trusted = trusted && !misleading(*effects_[a], separation.members()[a].blocks[block].inner,
                                       experiment.record, input_.fitted.reference_temperature_c);
    }
    if (!trusted) continue;
    MatrixXd added = squared(separation, walks, &experiment.record);
    for (Index i = 0; i < added.size(); ++i) {
      if (!std::isfinite(added(i))) continue;
      added(i) = std::max(0.0, added(i) - present_squared_(i));
    }
    weighed_.push_back({&experiment, std::move(added)});
  }
}

/// What the members act through, and along which axes: those that they name; where they name none,
/// those that were swept, or else all.
bool SetChoice::concerns(const Experiment& experiment) const {
  std::string axes;
  Experiment::About set;
  for (const Effect* effect : effects_) {
    for (const std::string_view signal : effect->info().signals) {
      for (const FieldSignal& field : kFieldSignals) {
        if (signal != field.name) continue;
        axes += field.axis;
        set.field = true;
      }
      set.field |= signal == "coil_heat";
      set.temperature |= signal.starts_with("temperature_") || signal == "heater_w";
      set.azimuth |= signal == "azimuth_deg";
    }
  }
  if (axes.empty()) axes = state_of(present_.table).moving_axes;
  const bool on_axis =
      experiment.axis == 0 || axes.empty() || axes.find(experiment.axis) != std::string::npos;
  const Experiment::About& about = experiment.about;
  if (!about.field && !about.temperature && !about.azimuth) return true;
  if (about.together) return set.field && set.temperature && on_axis;
  return (about.field && set.field && on_axis) || (about.temperature && set.temperature) ||
         (about.azimuth && set.azimuth);
}

SetChoice::Pairs SetChoice::pairs_with(Index rival) const {
  Pairs pairs{{0, rival}};
  if (static_cast<std::size_t>(rival) < effects_.size()) pairs.emplace_back(rival, 0);
  return pairs;
}

SetChoice::Pairs SetChoice::all_pairs() const {
  Pairs pairs;
  for (Index a = 0; a < static_cast<Index>(effects_.size()); ++a) {
    for (Index b = 0; b < static_cast<Index>(names_.size()); ++b) {
      if (a != b) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

double SetChoice::least(const MatrixXd& squared, const Pairs& pairs) const {
  double out = std::numeric_limits<double>::infinity();
  for (const auto& [a, b] : pairs) out = std::min(out, squared(a, b));
  return std::sqrt(out);
}

std::string SetChoice::of_present(const Pairs& pairs) const {
  double once = 0.0;
  for (const Weighed& w : weighed_) {
    if (w.experiment->key == kRepeat) once = least(w.squared, pairs);
  }
  // A jump is sought at the same time in every run: one that does not come back looks like one that
  // was half as high.
  const bool jump = std::any_of(effects_.begin(), effects_.end(),
                                [](const Effect* effect) { return effect->info().is_jump(); });
  const double times = std::ceil(std::pow(kAim / std::max(once, 1e-9), 2));
  if (jump || times > kMostPresentTimes) {
    return "repeating the present run would not: they look alike in it";
  }
  return fmt::format("so would {:.0f} more of the present run, in {:.1f} h", times,
                     times * present_.hours);
}

std::vector<NextMeasurement> SetChoice::best_for(const Pairs& pairs,
                                                 std::vector<std::string> names) const {
  struct Choice {
    const Experiment* experiment;
    double separation;
    int times;
    double hours() const { return times * experiment->record.hours; }
    double effort() const { return hours() * (experiment->by_hand ? kByHand : 1.0); }
  };
  std::vector<Choice> choices;
  for (const Weighed& w : weighed_) {
    const double s = least(w.squared, pairs);
    if (s * std::sqrt(kMostTimes) < kAim) continue;
    const int times = std::max(1, static_cast<int>(std::ceil(std::pow(kAim / s, 2))));
    choices.push_back({w.experiment, s * std::sqrt(times), times});
  }
  std::stable_sort(choices.begin(), choices.end(),
                   [](const Choice& a, const Choice& b) { return a.effort() < b.effort(); });
  std::vector<NextMeasurement> out;
  for (const Choice& c : choices) {
    if (!out.empty() &&
        (out.size() > 1 || c.effort() > kNearlyAsQuick * choices.front().effort())) {
      break;
    }
    std::string text = c.experiment->action;
    if (walk_ && c.experiment->key.starts_with("rest_")) text += " and give it as --quiet";
    if (c.times > 1) text += fmt::format(", {} times", c.times);
    text += fmt::format(": expected to tell them apart at {:.0f} sigma ({} are enough) in {:.1f} h",
                        c.separation, kSeparates, c.hours());
    if (out.empty() && c.experiment->key != kRepeat) text += "; " + of_present(pairs);
    out.push_back({.tells_apart = names,
                   .action = std::move(text),
                   .separation = c.separation,
                   .hours = c.hours(),
                   .times = c.times,
                   .experiment = c.experiment->key});
  }
  return out;
}

std::vector<NextMeasurement> SetChoice::choose() const {
  std::vector<NextMeasurement> out;
  if (weighed_.empty()) return out;
  // What comes apart in the present data already, at the size that was fitted, is no question.
  Pairs open = all_pairs();
  std::erase_if(open, [&](const auto& pair) {
    Pairs both{pair};
    if (static_cast<std::size_t>(pair.second) < effects_.size()) {
      both.emplace_back(pair.second, pair.first);
    }
    return least(present_squared_, both) >= kAim;
  });
  out = best_for(open.empty() ? all_pairs() : open, names_);
  if (!out.empty()) return out;
  for (Index rival = 1; rival < static_cast<Index>(names_.size()); ++rival) {
    const Pairs pairs = pairs_with(rival);
    const std::vector<std::string> two{names_.front(), names_[static_cast<std::size_t>(rival)]};
    const auto best = best_for(pairs, two);
    if (!best.empty()) {
      // One line for all rivals that the same experiment settles.
      const auto same = std::find_if(out.begin(), out.end(), [&](const NextMeasurement& n) {
        return n.experiment == best.front().experiment && n.times == best.front().times;
      });
      if (same == out.end()) {
        out.push_back(best.front());
        continue;
      }
      std::vector<std::string> names = same->tells_apart;
      names.push_back(two.back());
      if (best.front().separation < same->separation) *same = best.front();
      same->tells_apart = std::move(names);
      continue;
    }
    if (const double s = least(present_squared_, pairs); s >= kAim) {
      out.push_back({.tells_apart = two,
                     .action = fmt::format("repeat the present run, to make sure: at the size that "
                                           "was fitted they come apart at {:.0f} sigma in it",
                                           s),
                     .separation = s,
                     .hours = present_.hours});
      continue;
    }
    out.push_back({.tells_apart = two,
                   .action = fmt::format("none of the {} experiments that this bench knows would "
                                         "tell them apart at the size that was fitted",
                                         weighed_.size()),
                   .purpose = NextMeasurement::Purpose::kNoneTells});
  }
  return out;
}

}  // namespace fogbench::model
