#pragma once
// A plot as one SVG element: axes with round ticks, series of marks, lines, marked bands. How a
// series looks beyond the shape of its marks is the page's style to say, by the series' kind.

#include <string>
#include <utility>
#include <vector>

namespace fogbench::model {

struct SvgPlot {
  /// Shapes that stay apart on grey paper. The triangles point the way that x goes.
  enum class Mark { kDot, kSquare, kRight, kLeft };
  struct Series {
    std::string kind = "point";  ///< CSS classes
    Mark mark = Mark::kDot;
    bool joined = false;  ///< by a line in the order of the points, broken where one is missing
    std::vector<std::pair<double, double>> points;
    /// Which rows of the table each point stands for ("12", or "12,13" for their mean), for a
    /// script that links plots; as many as points, or none.
    std::vector<std::string> rows;
  };
  struct Band {
    double from, to;    ///< along x
    std::string title;  ///< shown when pointed at
    std::string label;  ///< a number, drawn above it where there is room
  };
  std::string title;
  std::string x_label, y_label;
  std::vector<Series> series;
  std::vector<Band> bands;  ///< failing ranges
  bool diagonal = false;    ///< the line y = x
  bool zero_line = false;   ///< the line y = 0
  double envelope = 0.0;    ///< dashed lines at y = +-envelope; 0: none
  std::string kind;         ///< CSS class of the whole; empty: none
  bool decimal_comma = false;

  /// Points that are not finite are left out; empty when none is left.
  std::string svg() const;
};

/// Round numbers that cover [low, high], some five of them.
std::vector<double> round_ticks(double low, double high);
/// &, <, > and quotes made safe for HTML and SVG.
std::string escaped(const std::string& text);

}  // namespace fogbench::model
