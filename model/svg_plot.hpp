#pragma once
// A scatter plot as one SVG element: axes with round ticks, points, marked bands.

#include <string>
#include <utility>
#include <vector>

namespace fogbench::model {

struct SvgPlot {
  struct Band {
    double from, to;    ///< along x
    std::string title;  ///< shown when pointed at
  };
  std::string title;
  std::string x_label, y_label;
  std::vector<std::pair<double, double>> points;
  std::vector<Band> bands;  ///< failing ranges
  bool diagonal = false;    ///< the line y = x
  bool zero_line = false;   ///< the line y = 0
  double envelope = 0.0;    ///< dashed lines at y = +-envelope; 0: none

  /// Points that are not finite are left out.
  std::string svg() const;
};

/// Round numbers that cover [low, high], some five of them.
std::vector<double> round_ticks(double low, double high);
/// &, <, > and quotes made safe for HTML and SVG.
std::string escaped(const std::string& text);

}  // namespace fogbench::model
