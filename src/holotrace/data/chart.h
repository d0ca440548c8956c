#pragma once

#include <string>
#include <vector>

namespace holotrace {

/// One line, outline or set of points of a chart.
struct Series {
  std::string name;  ///< in the key; "": none
  std::vector<double> x, y;
  bool has_markers = false;  ///< points, beside the line
  bool has_line = true;
  bool is_dashed = false;  ///< the line: for limits and references
  bool is_filled = false;  ///< the area that the line encloses, in a pale shade of its colour
  int colour = -1;         ///< place in the palette; -1: the series' own place among the others
};

/// Words beside a point of a chart.
struct ChartLabel {
  std::string text;
  double x = 0, y = 0;
};

/// A picture of curves: what sweeps and convergence are drawn with. Labels carry their units: "distance [mm]".
struct Chart {
  std::string title, x_label, y_label;
  std::vector<Series> series;
  bool is_log_x = false, is_log_y = false;
  bool is_equal_aspect = false;  ///< one unit of x is as long as one of y: for shapes in space
  std::vector<ChartLabel> labels;
};

/// @throws Error, naming the series, unless there is one with points, as many x as y, all finite, and above 0 on a
///         logarithmic axis, and every series has a line or markers; labels stand at such points too
void check_chart(const Chart& chart);

}  // namespace holotrace
