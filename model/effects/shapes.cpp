#include "model/effects/shapes.hpp"

namespace fogbench::model {
namespace {

using Eigen::MatrixXd;

std::vector<double> parameters_of(double first, const std::vector<double>& further) {
  std::vector<double> all{first};
  all.insert(all.end(), further.begin(), further.end());
  return all;
}

/// The same columns with those of the memory's beginnings after them.
Shape with_starts(Shape shape, const Effect& effect, const Signals& signals,
                  const std::vector<double>& further = {}) {
  return [shape = std::move(shape), &effect, &signals, further](double inner) {
    const MatrixXd own = shape(inner);
    const MatrixXd starts = effect.starts(signals, parameters_of(inner, further));
    MatrixXd out(own.rows(), own.cols() + starts.cols());
    out << own, starts;
    return out;
  };
}

}  // namespace

std::vector<Shape> shapes_of(const Effect& effect, const Signals& signals) {
  std::vector<Shape> out{[&effect, &signals](double inner) {
    const std::vector<double> parameters(effect.info().parameters.empty() ? 0 : 1, inner);
    return effect.regressor(signals, parameters);
  }};
  for (Shape& other : effect.other_shapes(signals)) out.push_back(std::move(other));
  if (!effect.info().has_history) return out;
  for (Shape& shape : out) shape = with_starts(std::move(shape), effect, signals);
  return out;
}

std::vector<Shape> shapes_of_form(const Effect& form, const Signals& signals,
                                  const std::vector<double>& further) {
  // What a further parameter may be off by, and a mixture of several: nature knows no sech^2.
  constexpr double kOff[] = {1.1, 1.6};
  std::vector<std::vector<double>> places{further};
  for (std::size_t i = 0; i < further.size(); ++i) {
    for (const double factor : kOff) {
      places.push_back(further);
      places.back()[i] *= factor;
    }
  }
  std::vector<Shape> out;
  for (const std::vector<double>& place : places) {
    const auto own = [&form, &signals, place](double inner) {
      return form.regressor(signals, parameters_of(inner, place));
    };
    out.push_back(with_starts(own, form, signals, place));
  }
  return out;
}

}  // namespace fogbench::model
