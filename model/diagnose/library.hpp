#pragma once
// What a diagnosis tries: every catalogue effect that the table can show, on a grid of its inner
// parameter, and beside them shapes that no effect of the catalogue has. Without those shadows an
// effect from outside the catalogue would be named confidently and wrongly.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "config/model_file.hpp"
#include "model/effect.hpp"
#include "model/signals.hpp"

namespace fogbench::model {

/// One point of the inner parameter's grid: `width` neighbouring columns of Library::columns.
struct Block {
  Eigen::Index first = 0;
  Eigen::Index width = 1;
  std::vector<double> inner;
};

struct Candidate {
  std::string name;
  const Effect* effect = nullptr;  ///< null for shadows and for a user's expression
  bool shadow = false;
  bool slow = false;  ///< acts on the scale of the whole run: a random walk may look like it
  std::vector<Block> blocks;
};

struct NotTestable {
  std::string effect;
  std::string because;
};

struct Library {
  std::vector<Candidate> candidates;
  Eigen::MatrixXd columns;  ///< one row per table row, finite
  std::vector<NotTestable> not_testable;
};

/// Effects that stand in `model` already are left out; effects whose signals are missing or never
/// excited are listed with the reason.
Library make_library(const Signals& signals, const config::ModelFile& model);

/// Smooth functions of each variable that moves, in blocks: what an adequate model leaves flat.
/// Candidate names say the variables ("field_z_ut", "temperature_c x time_s").
Library make_smooth_library(const Signals& signals);

/// The effect's columns with missing entries (signal not recorded in these rows) as zero.
Eigen::MatrixXd finite_regressor(const Effect& effect, const Signals& signals,
                                 std::span<const double> inner);

}  // namespace fogbench::model
