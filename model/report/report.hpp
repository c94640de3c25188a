#pragma once
// A comparison as one self-contained HTML page: the conclusions, measured against modelled rate,
// the residual by each variable with the failing ranges marked, loops, and the tables. SVG drawn
// here; no network; prints on paper, and reads without its small script.

#include <string>

#include "model/compare/compare.hpp"

namespace fogbench::model {

/// `data_name`: what was compared, for the heading. At most some 2,000 points are drawn in each
/// plot.
std::string report_html(const Comparison& comparison, const Table& table,
                        const config::ModelFile& model, const std::string& data_name);

}  // namespace fogbench::model
