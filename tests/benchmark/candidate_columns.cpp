#include "tests/benchmark/candidate_columns.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <set>

#include "model/effects/catalogue.hpp"

namespace fogbench::tests {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kInnerValues = 8;
constexpr int kInstants = 40;  // where something may jump
// A column that the base model takes up to this share has nothing left to show.
constexpr double kUntestable = 1e-3;

/// A signal that moves less than this shows its instrument's noise, not an effect.
double least_span(std::string_view signal) {
  if (signal.starts_with("field_")) return 5.0;
  if (signal == "temperature_c" || signal == "temperature_rate_c_per_h") return 0.5;
  if (signal == "temperature_gradient_c") return 0.05;
  if (signal == "heater_w" || signal == "ambient_c") return 0.2;
  return 0.0;
}

bool excited(const model::EffectInfo& info, const model::Signals& signals) {
  for (const std::string_view name : info.signals) {
    const auto signal = signals.signal(name);
    if (!(signal.maxCoeff() - signal.minCoeff() > least_span(name))) return false;
  }
  if (!info.id.starts_with("magnetic_cross")) return true;
  const auto a = signals.signal(info.signals[0]).array(),
             b = signals.signal(info.signals[1]).array();
  return (a * b).abs().maxCoeff() > 0.1 * a.abs().maxCoeff() * b.abs().maxCoeff();
}

std::vector<std::vector<double>> inner_values(const model::EffectInfo& info,
                                              const model::Signals& signals) {
  if (info.parameters.empty()) return {{}};
  const model::InnerParameter& parameter = info.parameters.front();
  double least = parameter.minimum, most = parameter.maximum;
  if (!parameter.within.empty()) {
    const auto range = signals.signal(parameter.within);
    least = range.minCoeff();
    most = range.maxCoeff();
  }
  const int values = parameter.name == "t0" ? kInstants : kInnerValues;
  std::vector<std::vector<double>> out;
  for (int i = 0; i < values; ++i) {
    const double share = (i + 0.5) / values;
    out.push_back({parameter.logarithmic ? least * std::pow(most / least, share)
                                         : least + share * (most - least)});
  }
  return out;
}

}  // namespace

CandidateColumns candidate_columns(const model::Signals& signals, const config::ModelFile& model,
                                   const Whitening& whiten) {
  const auto rows = static_cast<Index>(signals.rows());
  MatrixXd base(rows, static_cast<Index>(model.terms.size()));
  std::set<std::string_view> present;
  for (std::size_t i = 0; i < model.terms.size(); ++i) {
    const model::Effect* effect = model::find_effect(model.terms[i].effect);
    base.col(static_cast<Index>(i)) = effect->regressor(signals, {});
    present.insert(effect->info().id);
  }
  base = whiten(base);
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(base);
  const MatrixXd q = qr.householderQ() * MatrixXd::Identity(rows, qr.rank());
  const auto clear = [&](const MatrixXd& a) -> MatrixXd { return a - q * (q.transpose() * a); };

  CandidateColumns out;
  out.base_columns = qr.rank();
  out.y = clear(whiten(signals.signal(model.observable)));
  std::vector<VectorXd> columns;
  for (const model::Effect* effect : model::catalogue()) {
    const model::EffectInfo& info = effect->info();
    if (present.contains(info.id) || !signals.missing_for(info).empty() ||
        !excited(info, signals)) {
      continue;
    }
    for (const auto& inner : inner_values(info, signals)) {
      const MatrixXd raw = effect->regressor(signals, inner);
      if (!raw.allFinite()) continue;
      const MatrixXd white = whiten(raw);
      const MatrixXd left = clear(white);
      CandidateColumns::Group group{.effect = std::string(info.id),
                                    .first = static_cast<Index>(columns.size()),
                                    .inner_parameters = static_cast<double>(inner.size())};
      for (Index j = 0; j < left.cols(); ++j) {
        if (left.col(j).norm() <= kUntestable * white.col(j).norm()) continue;
        columns.push_back(left.col(j).normalized());
        ++group.width;
      }
      if (group.width > 0) out.groups.push_back(std::move(group));
    }
  }
  out.columns.resize(rows, static_cast<Index>(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j) {
    out.columns.col(static_cast<Index>(j)) = columns[j];
  }
  return out;
}

CandidateColumns::Nearest CandidateColumns::nearest(const VectorXd& column,
                                                    const std::string& own) const {
  Nearest out;
  for (const Group& group : groups) {
    if (group.effect == own) continue;
    const MatrixXd x = columns.middleCols(group.first, group.width);
    const double cosine = (x * x.colPivHouseholderQr().solve(column)).norm() / column.norm();
    if (cosine > out.cosine) out = {group.effect, cosine};
  }
  return out;
}

}  // namespace fogbench::tests
