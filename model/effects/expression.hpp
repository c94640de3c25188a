#pragma once
// A term that the user writes as a formula over the table's columns, as a regressor.
//
//   + - * / ^ (power, right to left, stronger than the sign), ( ), < <= > >= == != && || ?:
//   sin cos tan asin acos atan atan2(y, x) sinh cosh tanh asinh acosh atanh
//   exp ln log (natural) log2 log10 sqrt abs sign rint min max sum avg, pi, e
//
// Names are columns of the table (or signals derived from them) and inner parameters.

#include <Eigen/Core>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "config/result.hpp"
#include "model/table/signals.hpp"

namespace mu {
class Parser;
}

namespace fogbench::model {

/// The names of the functions that a formula may call, in order.
const std::vector<std::string>& expression_functions();

/// Not thread-safe: copies share one parser.
class Expression {
 public:
  /// `term` names the term in errors; `parameters` are all names that the model declares as inner
  /// parameters. Errors: kBadInput: syntax, a name that is neither a signal nor a parameter, or
  /// both.
  static Result<Expression> parse(const std::string& term, const std::string& text,
                                  const std::set<std::string>& parameters, const Signals& signals);

  /// Signals and parameters that the formula uses, by name.
  const std::vector<std::string>& signals() const { return signals_; }
  const std::vector<std::string>& parameters() const { return parameters_; }

  /// One value a row; NaN and infinities as the arithmetic gives them. `values` in the order of
  /// parameters().
  Eigen::VectorXd evaluate(const Signals& signals, std::span<const double> values) const;

 private:
  std::string text_;
  std::shared_ptr<mu::Parser>
      parser_;  // shared by copies: making one costs more than a small table
  std::vector<std::string> signals_;
  std::vector<std::string> parameters_;
};

}  // namespace fogbench::model
