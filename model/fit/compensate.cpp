#include "model/fit/compensate.hpp"

#include <Eigen/Core>
#include <cmath>

#include "model/fit/predict.hpp"

namespace fogbench::model {
namespace {

/// Root mean square, and the same about the mean, of the values that are numbers.
class Spread {
 public:
  void add(double value) {
    // Welford's update keeps the digits of a small scatter on a large bias.
    ++count_;
    const double delta = value - mean_;
    mean_ += delta / static_cast<double>(count_);
    squares_ += delta * (value - mean_);
  }
  std::size_t count() const { return count_; }
  double deviation() const { return std::sqrt(squares_ / static_cast<double>(count_)); }
  double rms() const { return std::hypot(mean_, deviation()); }

 private:
  std::size_t count_ = 0;
  double mean_ = 0.0, squares_ = 0.0;
};

}  // namespace

Result<Compensation> compensate(const Table& table, const config::ModelFile& model) {
  if (!table.has(model.observable)) {
    return Error{ErrorCode::kBadInput, table.why_missing(model.observable)};
  }
  const Result<Eigen::VectorXd> predicted = predict(table, model);
  if (!predicted) return predicted.error();
  const std::span<const double> observed = table.column(model.observable);
  Compensation result;
  result.column = "compensated_" + model.observable;
  result.values.resize(table.rows());
  Spread before, after;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    result.values[row] = observed[row] - (*predicted)[static_cast<Eigen::Index>(row)];
    if (std::isnan(result.values[row])) continue;
    before.add(observed[row]);
    after.add(result.values[row]);
  }
  if (after.count() == 0) {
    return Error{ErrorCode::kBadInput,
                 "found no row in which the observable and every column of the model has a number"};
  }
  result.rows = after.count();
  result.rms_before = before.rms();
  result.rms_after = after.rms();
  result.deviation_before = before.deviation();
  result.deviation_after = after.deviation();
  return result;
}

}  // namespace fogbench::model
