#pragma once
// What a diagnosis tries: every catalogue effect that the table can show, on a grid of its inner
// parameter, the user's own terms, changes between runs, and beside them shapes that no effect of
// the catalogue has (shadows). Without the shadows an effect from outside the catalogue would be
// named confidently and wrongly.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "config/model_file.hpp"
#include "model/diagnose/working_table.hpp"
#include "model/effects/effect.hpp"
#include "model/effects/shapes.hpp"
#include "model/table/signals.hpp"

namespace fogbench::model {

/// One point of the inner parameter's grid: `width` neighbouring columns of Library::columns.
struct Block {
  Eigen::Index first = 0;
  Eigen::Index width = 1;
  std::size_t shape = 0;  ///< into Candidate::shapes
  double inner = 0.0;
};

struct Candidate {
  enum class Kind { kEffect, kShadow };

  std::string name;
  Kind kind = Kind::kShadow;
  std::vector<config::ModelTerm> terms;  ///< what would be added to the model; shadows: none
  std::vector<std::string> units;        ///< of the coefficients
  /// The gridded inner parameter; nothing: there is none.
  std::optional<InnerParameter> parameter;
  std::string parameter_name;  ///< of a user's term; catalogue effects name theirs in `parameter`
  /// Columns on the rows of WorkingTable, the catalogue's own shape first. Shadows have none.
  std::vector<Shape> shapes;
  /// The first of a shape's columns are the effect, those that follow how its memory began: these
  /// belong to the data, and are no evidence of the effect.
  Eigen::Index own = 1;
  /// The variable of which the effect is a curve: no memory, nothing else. Empty: it is more.
  std::string curve_over;
  /// The simpler effect that it becomes in a limit of its inner parameter, and that is meant where
  /// this one does hardly better. Empty: none, or the catalogue's own affair.
  std::string extends;
  /// The simpler effect at one end of its inner parameter (EffectInfo::limit).
  std::string limit;
  bool pulse = false;  ///< begins and ends at an instant: two jumps
  bool slow = false;   ///< acts on the scale of the whole run: a random walk may look like it
  std::vector<Block> blocks;

  bool shadow() const { return kind == Kind::kShadow; }
  /// The inner parameter is an instant: its likelihood is a staircase, without a tangent.
  bool instant() const { return parameter && parameter->instant; }
  /// Distance between the grid points around a value of the inner parameter.
  double spacing(double inner) const;
};

struct NotTestable {
  std::string effect;
  std::string because;
};

struct Library {
  std::vector<Candidate> candidates;  ///< the shadows last
  Eigen::MatrixXd columns;            ///< one row per row of WorkingTable, finite
  std::vector<NotTestable> not_testable;

  /// So many of the first columns hold those of all effects, or of all candidates.
  Eigen::Index columns_of(bool effects_alone) const;
};

/// What libraries are made from. All must outlive the library.
struct LibrarySource {
  const WorkingTable& table;
  const Signals& signals;  ///< of table.fine()
  const config::ModelFile& model;
  const std::vector<config::ModelTerm>& users_terms;
  /// Forms that stand in the place of the effects that they are forms of (EffectInfo::form_of),
  /// each with values for its inner parameters.
  std::vector<config::ModelTerm> forms = {};
};

/// Effects that stand in the model already, themselves or in another form, are left out; effects
/// whose signals are missing or never excited are listed with the reason. Errors: kBadInput: a
/// user's term that cannot be evaluated.
Result<Library> make_library(const LibrarySource& source);

}  // namespace fogbench::model
