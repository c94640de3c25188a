#include "model/effects/loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>

#include "model/effects/function_effect.hpp"
#include "model/effects/history.hpp"

namespace fogbench::model::effects {
namespace {

/// Plays whose mean stands for those of one part.
constexpr std::size_t kPlaysOfPart = 8;

struct LoopInput {
  std::string_view hysteresis;  ///< the effect of which these are forms
  std::string_view signal;
  std::string_view loop, saturating;  ///< names; empty: there is none
  std::string_view symbol, unit;
  InnerParameter width;
};

constexpr InnerParameter kFieldWidth{
    .name = "width", .unit = "100 uT", .minimum = 0.1, .maximum = 3.0};
constexpr InnerParameter kFieldScale{
    .name = "hs", .unit = "100 uT", .minimum = 0.3, .maximum = 6.0};
constexpr LoopInput kLoopInputs[] = {
    {"magnetic_hysteresis_x", "field_x_ut", "magnetic_loop_x", "magnetic_saturating_loop_x", "h_x",
     "deg/h per 100 uT", kFieldWidth},
    {"magnetic_hysteresis_y", "field_y_ut", "magnetic_loop_y", "magnetic_saturating_loop_y", "h_y",
     "deg/h per 100 uT", kFieldWidth},
    {"magnetic_hysteresis_z", "field_z_ut", "magnetic_loop_z", "magnetic_saturating_loop_z", "h_z",
     "deg/h per 100 uT", kFieldWidth},
    {"temperature_hysteresis",
     "temperature_c",
     "temperature_loop",
     "",
     "t",
     "deg/h/degC",
     {.name = "width", .unit = "degC", .minimum = 0.5, .maximum = 20.0}}};

class Loop final : public Effect {
 public:
  Loop(const LoopInput& input, bool saturates, std::size_t parts)
      : input_(input), saturates_(saturates), parts_(parts) {
    info_.id = fmt::format("{}({})", saturates ? input.saturating : input.loop, parts);
    info_.formula =
        fmt::format("density of {}, r = 0 ... width",
                    fmt::format(fmt::runtime(saturates ? "hs tanh(play_r({}) / hs)" : "play_r({})"),
                                input.symbol));
    for (std::size_t k = 1; k <= parts; ++k) {
      info_.columns.push_back(parts > 1 ? std::to_string(k) : "");
    }
    info_.units.assign(parts, std::string(input.unit));
    info_.signals = {std::string(input.signal)};
    info_.parameters = {input.width};
    if (saturates) info_.parameters.push_back(kFieldScale);
    info_.excited_by = "up and down branches, and smaller loops within the largest";
    info_.confused_with = input.hysteresis;
    info_.source = "M. Brokate, J. Sprekels, Hysteresis and Phase Transitions (Springer 1996)";
    info_.has_history = true;
    info_.form_of = input.hysteresis;
  }

  const EffectInfo& info() const override { return info_; }

  Eigen::MatrixXd regressor(const Signals& signals, std::span<const double> inner) const override {
    const Eigen::VectorXd u = input_of(signals);
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(u.size(), static_cast<Eigen::Index>(parts_));
    for (std::size_t i = 0; i < parts_ * kPlaysOfPart; ++i) {
      const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(kPlaysOfPart);
      out.col(static_cast<Eigen::Index>(i / kPlaysOfPart)) +=
          flattened(play(signals, u, half_width(share, inner)), inner) / kPlaysOfPart;
    }
    return out;
  }

  /// All plays at one end of their bands, as an input leaves them that was larger than all of them:
  /// a column for each end, whatever the number of parts.
  Eigen::MatrixXd starts(const Signals& signals, std::span<const double> inner) const override {
    const Eigen::VectorXd u = input_of(signals);
    Eigen::MatrixXd out;
    for (std::size_t part = 0; part < parts_; ++part) {
      const double width = half_width(static_cast<double>(part) + 0.5, inner);
      const Eigen::VectorXd assumed = play(signals, u, width), rest = flattened(assumed, inner);
      const Eigen::MatrixXd moved = play_starts(signals, u, width);
      if (out.size() == 0) out = Eigen::MatrixXd::Zero(moved.rows(), moved.cols());
      for (Eigen::Index c = 0; c < moved.cols(); ++c) {
        out.col(c) += flattened(assumed + moved.col(c), inner) - rest;
      }
    }
    return out;
  }

 private:
  /// `share`: parts from the middle of the density.
  double half_width(double share, std::span<const double> inner) const {
    return share / static_cast<double>(parts_) * inner[0];
  }
  Eigen::VectorXd input_of(const Signals& signals) const {
    if (input_.signal == "temperature_c") return excess_temperature(signals);
    return field(signals, input_.signal);
  }
  Eigen::VectorXd flattened(const Eigen::VectorXd& p, std::span<const double> inner) const {
    if (!saturates_) return p;
    return inner[1] * (p / inner[1]).array().tanh();
  }

  const LoopInput& input_;
  bool saturates_;
  std::size_t parts_;
  EffectInfo info_;
};

/// By parts first, the saturating form of each after the one that does not.
const std::vector<std::unique_ptr<const Effect>>& all_loops() {
  static const auto all = [] {
    std::vector<std::unique_ptr<const Effect>> made;
    for (const LoopInput& input : kLoopInputs) {
      for (std::size_t parts = 1; parts <= kMostLoopParts; ++parts) {
        made.push_back(std::make_unique<Loop>(input, false, parts));
        if (!input.saturating.empty()) made.push_back(std::make_unique<Loop>(input, true, parts));
      }
    }
    return made;
  }();
  return all;
}

}  // namespace

const Effect* find_loop(std::string_view id) {
  const auto& all = all_loops();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& loop) { return loop->info().id == id; });
  return found == all.end() ? nullptr : found->get();
}

std::vector<const Effect*> loops_of(std::string_view effect) {
  std::vector<const Effect*> out;
  for (const auto& loop : all_loops()) {
    if (loop->info().form_of == effect) out.push_back(loop.get());
  }
  return out;
}

}  // namespace fogbench::model::effects
