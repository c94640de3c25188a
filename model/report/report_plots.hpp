#pragma once
// The plots of a page: measured against model, the residual by each variable, loops. A second fit
// of the same table, if there is one, is drawn over the first: before in grey, after in colour.

#include <string>
#include <string_view>
#include <vector>

#include "config/model_file.hpp"
#include "model/compare/compare.hpp"
#include "model/table/table.hpp"

namespace fogbench::model {

/// All must outlive the plots.
struct PlottedFits {
  const Table& table;
  const config::ModelFile& model;
  const Comparison& comparison;  ///< its fit comes first; its failing regions are marked
  const FitResult* after = nullptr;
  double noise_floor = 0.0;  ///< dashed at twice this; NaN: unknown
};

/// The regions that fail by more than noise, worst first. Plots and lists number them in this
/// order, from 1.
std::vector<const Region*> failing_regions(const Comparison& comparison);

std::string measured_against_model(const PlottedFits& fits);
/// The residual by each variable that was cut into ranges, the worst first, failing ranges marked.
std::string residual_plots(const PlottedFits& fits);
/// The residual over each field and the temperature, joined in the order of time, where they were
/// passed up and down; empty where they were not.
std::string loop_plots(const PlottedFits& fits);
/// What the marks of these plots mean.
std::string plot_legend(const PlottedFits& fits);
/// What marks of loops mean.
std::string loop_legend(const PlottedFits& fits);

/// For page_end(): run, segment, variables and residuals of each plotted row.
std::string rows_json(const PlottedFits& fits);

}  // namespace fogbench::model
