#pragma once
// What the plots of a page are drawn from: the fits' values and the variables, row by row of the
// table. For the report_*.cpp files only.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/report/report_plots.hpp"
#include "model/report/svg_plot.hpp"
#include "model/table/signals.hpp"

namespace fogbench::model {

/// One per row of the table, NaN where there is none.
using RowValues = std::vector<double>;

/// A fit as a plot draws it.
struct Layer {
  const FitResult& fit;
  std::string kind;
  SvgPlot::Mark mark;
};

/// The comparison's fit, and the one after it if there is one.
std::vector<Layer> layers_of(const PlottedFits& fits);

/// `values` as the fit has them: one for each row that took part.
RowValues by_table_row(const PlottedFits& fits, const FitResult& fit,
                       const Eigen::VectorXd& values);
/// A signal in the unit that it is plotted in: time in hours.
RowValues plotted_values(const PlottedFits& fits, const Signals& signals,
                         const std::string& variable);
/// Variables that were cut into ranges, in the order of how badly their worst range fails; time in
/// any case.
std::vector<std::string> plotted_variables(const PlottedFits& fits, const Signals& signals);
/// Evenly thinned, the same in all plots, in the order of the table.
std::vector<std::size_t> plotted_rows(const PlottedFits& fits);

/// Axes, zero line and noise of a plot of residuals.
SvgPlot residual_axes(const PlottedFits& fits, const std::string& title,
                      const std::string& variable);
/// The plot, with what is drawn of the second fit alone on axes of its own, for the page's switch.
std::string figure(const SvgPlot& plot, const std::string& caption = "");
/// An entry of a legend: `picture` is SVG on 28 by 14.
std::string legend_entry(std::string_view kind, std::string_view picture, std::string_view words);

}  // namespace fogbench::model
