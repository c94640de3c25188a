#include "model/diagnose/smooth_library.hpp"

#include "model/diagnose/library_builder.hpp"
#include "model/table/moving_signals.hpp"

namespace fogbench::model {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Library make_smooth_library(const LibrarySource& source) {
  LibraryBuilder builder(source);
  const auto moving = moving_signals(source.signals);
  for (const MovingSignal& a : moving) {
    // A gentle curve and a lively one.
    Candidate curve{.name = a.name};
    for (const int degree : {3, 6}) {
      builder.add_block(curve, builder.averaged(legendre(a.scaled, degree)));
    }
    builder.add(std::move(curve));
    const VectorXd going = direction(source.signals, a.value);
    if (a.name == "time_since_start_s" || going.minCoeff() >= 0.0) continue;
    MatrixXd branches(going.size(), 4);
    branches << going, going.asDiagonal() * legendre(a.scaled, 3);
    Candidate history{.name = "history of " + a.name};
    builder.add_block(history, builder.averaged(branches));
    builder.add(std::move(history));
  }
  for (std::size_t i = 0; i < moving.size(); ++i) {
    for (std::size_t j = i + 1; j < moving.size(); ++j) {
      builder.add_shadow(moving[i].name + " x " + moving[j].name,
                         moving[i].scaled.cwiseProduct(moving[j].scaled));
    }
  }
  return builder.finish();
}

}  // namespace fogbench::model
