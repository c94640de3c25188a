#include "model/diagnose/formula_search.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "model/diagnose/formula_parts.hpp"
#include "model/diagnose/heldout.hpp"
#include "model/effects/expression.hpp"

namespace fogbench::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Noise as fiber-optic gyros have it, in units of N: what weighs the rows. Estimated from the data
/// it would take the structure that is sought for a random walk.
constexpr NoiseCoefficients kUsualNoise{.angle_random_walk_deg_per_sqrt_h = 1.0,
                                        .bias_instability_deg_per_h = 1.0,
                                        .rate_random_walk_deg_per_h_per_sqrt_h = 0.3};
constexpr int kMostParts = 3;
constexpr std::size_t kRefined = 24;  // the best of each round, whose constants are worth refining
constexpr int kRefinements = 6;       // halvings of a constant's freedom
// A further part has to bring the held-out RMS down by this factor.
constexpr double kLeastFall = 0.93;
constexpr double kLeastBeside = 1e-3;  // of a column, beside the base

/// One part, or the sine and cosine of one period.
using Group = std::vector<FormulaPart>;

class FormulaSearch {
 public:
  FormulaSearch(const LibrarySource& source, const MatrixXd& base, const VectorXd& y)
      : source_(source), base_(base), y_(y) {
    if (auto made = make_whitener(source.table.windows(), kUsualNoise))
      whitener_ = std::move(*made);
  }

  std::optional<Formula> run() {
    if (!whitener_ || y_.size() - base_.cols() < 8) return std::nullopt;
    use_base(base_);
    const double before = heldout(base_);
    double best = before;
    for (int round = 0; round < kMostParts; ++round) {
      const std::optional<Group> next = best_block(best);
      if (!next) break;
      parts_.insert(parts_.end(), next->begin(), next->end());
      use_base(with(values(parts_)));
    }
    if (parts_.empty()) return std::nullopt;
    Formula out{.expression = text(), .heldout_rms_without = before};
    const auto whole = Expression::parse("formula", out.expression, {}, source_.signals);
    if (!whole) return std::nullopt;
    out.heldout_rms = heldout(with(averaged(whole->evaluate(source_.signals, {}))));
    if (!(out.heldout_rms < kLeastFall * before)) return std::nullopt;
    return out;
  }

 private:
  MatrixXd averaged(const MatrixXd& fine) const {
    const bool quiet = source_.signals.available(kQuietColumn);
    if (!quiet) return source_.table.average(fine);
    const auto counts = 1.0 - source_.signals.signal(kQuietColumn).array();
    return source_.table.average((fine.array().colwise() * counts).matrix());
  }
  MatrixXd values(const Group& parts) const { return averaged(values_of(parts, source_.signals)); }
  MatrixXd with(const MatrixXd& more) const {
    MatrixXd out(base_.rows(), base_.cols() + more.cols());
    out << base_, more;
    return out;
  }
  double heldout(const MatrixXd& columns) const {
    return heldout_rms(source_.table.windows(), kUsualNoise, columns, y_,
                       source_.table.bench_rows());
  }

  void use_base(const MatrixXd& columns) {
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(whitener_->whiten(columns));
    q_ = qr.householderQ() * MatrixXd::Identity(columns.rows(), qr.rank());
    residual_ = whitener_->whiten(y_);
    residual_ -= q_ * (q_.transpose() * residual_);
    squares_ = std::max(residual_.squaredNorm(), 1e-300);
  }

  /// Whitened, cleared of the base, of unit length; zero where nothing is left or a value is not
  /// finite.
  MatrixXd cleared(const MatrixXd& columns) const {
    const MatrixXd finite = columns.array().isFinite().select(columns, 0.0);
    MatrixXd out = whitener_->whiten(finite);
    const VectorXd before = out.colwise().norm();
    out -= q_ * (q_.transpose() * out);
    for (Index i = 0; i < out.cols(); ++i) {
      const double left = out.col(i).norm();
      const bool alive = columns.col(i).allFinite() && left > kLeastBeside * before[i];
      out.col(i) *= alive ? 1.0 / left : 0.0;
    }
    return out;
  }

  /// Of one or two columns from cleared().
  double gain(const Eigen::Ref<const MatrixXd>& unit) const {
    const VectorXd along = unit.transpose() * residual_;
    if (unit.cols() == 1) return along[0] * along[0];
    const double cosine = unit.col(0).dot(unit.col(1)), sine2 = 1.0 - cosine * cosine;
    if (sine2 < 1e-6) return std::max(along[0] * along[0], along[1] * along[1]);
    return (along.squaredNorm() - 2.0 * cosine * along[0] * along[1]) / sine2;
  }

  /// Twice the fall of the log likelihood, and what the length costs. Smaller is better.
  double score(double gained, const Group& block) const {
    double length = 0.0;
    for (const FormulaPart& part : block) length += part.length;
    const auto rows = static_cast<double>(y_.size());
    const double left = std::max(1.0 - gained / squares_, 1e-12);
    return (rows - static_cast<double>(q_.cols())) * std::log(left) + length * std::log(rows);
  }
  double score(const Group& block) const { return score(gain(cleared(values(block))), block); }

  /// A sine is followed by its cosine.
  static bool begins_pair(const std::vector<FormulaPart>& parts, std::size_t i) {
    return i + 1 < parts.size() && parts[i].text.starts_with("sin(") &&
           parts[i + 1].text.starts_with("cos(");
  }

  void refine(Group& block, double& best) const {
    for (std::size_t c = 0; c < block.front().constants.size(); ++c) {
      double step = 0.5 * block.front().freedom[c];
      if (step == 0.0) continue;
      for (int i = 0; i < kRefinements; ++i, step *= 0.5) {
        for (const double sign : {-1.0, 1.0}) {
          Group trial = block;
          for (FormulaPart& part : trial) part.constants[c] += sign * step;
          const double its = score(trial);
          if (its >= best) continue;
          best = its;
          block = std::move(trial);
          break;
        }
      }
    }
  }

  /// The block with the best score that predicts held-out rows better than `heldout_so_far`, which
  /// is then what it leaves.
  std::optional<Group> best_block(double& heldout_so_far) {
    if (all_.empty()) {
      all_ = formula_parts(source_.signals);
      columns_ = values(all_);
    }
    const MatrixXd unit = cleared(columns_);
    std::vector<std::pair<double, Group>> ranked;
    for (std::size_t i = 0; i < all_.size(); ++i) {
      const bool pair = begins_pair(all_, i);
      Group block{all_[i]};
      if (pair) block.push_back(all_[i + 1]);
      const double its = score(gain(unit.middleCols(static_cast<Index>(i), pair ? 2 : 1)), block);
      if (its < 0.0) ranked.emplace_back(its, std::move(block));
      if (pair) ++i;
    }
    const auto better = [](const auto& a, const auto& b) { return a.first < b.first; };
    std::sort(ranked.begin(), ranked.end(), better);
    if (ranked.size() > kRefined) ranked.resize(kRefined);
    for (auto& [its, block] : ranked) refine(block, its);
    std::sort(ranked.begin(), ranked.end(), better);
    for (auto& [its, block] : ranked) {
      Group together = parts_;
      together.insert(together.end(), block.begin(), block.end());
      const double left = heldout(with(values(together)));
      if (!(left < kLeastFall * heldout_so_far)) continue;
      heldout_so_far = left;
      return std::move(block);
    }
    return std::nullopt;
  }

  /// One part by itself; several with the coefficients that they have together.
  std::string text() const {
    if (parts_.size() == 1) return text_of(parts_.front());
    const MatrixXd columns = with(values(parts_));
    const VectorXd beta = Eigen::ColPivHouseholderQR<MatrixXd>(whitener_->whiten(columns))
                              .solve(whitener_->whiten(y_));
    std::string out;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const double c = beta[base_.cols() + static_cast<Index>(i)];
      const char* sign = c < 0.0 ? (i > 0 ? " - " : "-") : (i > 0 ? " + " : "");
      out += fmt::format("{}{:.4g} * {}", sign, std::abs(c), text_of(parts_[i]));
    }
    return out;
  }

  const LibrarySource& source_;
  const MatrixXd& base_;
  const VectorXd& y_;
  std::unique_ptr<Whitener> whitener_;
  std::vector<FormulaPart> all_;
  MatrixXd columns_;
  Group parts_;  // chosen so far
  MatrixXd q_;
  VectorXd residual_;
  double squares_ = 0.0;
};

}  // namespace

std::optional<Formula> search_formula(const LibrarySource& source, const MatrixXd& base,
                                      const VectorXd& y) {
  return FormulaSearch(source, base, y).run();
}

}  // namespace fogbench::model
