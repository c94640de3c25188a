#pragma once
// The small expressions that formula_search adds up, each as text and as numbers.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/table/signals.hpp"

namespace fogbench::model {

struct FormulaPart {
  /// In an expression's syntax; "{0}", "{1}" stand for its constants.
  std::string text;
  std::vector<double> constants;
  /// Of each constant, by how much it may be moved while it is refined; 0: it stays.
  std::vector<double> freedom;
  double length = 1.0;  ///< what it costs: variables, operations and constants
};

/// The text with its constants in it, to four digits.
std::string text_of(const FormulaPart& part);

/// Parts over every signal that moves, further columns included.
std::vector<FormulaPart> formula_parts(const Signals& signals);

/// One column a part on the rows of the signals; not finite where a part is not.
Eigen::MatrixXd values_of(const std::vector<FormulaPart>& parts, const Signals& signals);

}  // namespace fogbench::model
