#pragma once

#include <string>
#include <vector>

namespace holotrace {

/// One line, outline or set of points of a chart.
struct Series {
  std::string name;  ///< name in the key; "": no entry
  std::vector<double> x, y;
  bool has_markers = false;  ///< draws the points, beside the line
  bool has_line = true;
  bool is_dashed = false;  ///< draws the line dashed: for limits and references
  bool is_filled = false;  ///< fills the area that the line encloses, in a pale shade of its colour
  int colour = -1;         ///< index in the palette; -1: the index of the series in the chart
};

/// A text beside a point of a chart.
struct ChartLabel {
  std::string text;
  double x = 0, y = 0;
};

/// A picture of curves, used for sweeps and convergence. Axis labels include their units: "distance [mm]".
struct Chart {
  std::string title, x_label, y_label;
  std::vector<Series> series;
  bool is_log_x = false, is_log_y = false;
  bool is_equal_aspect = false;  ///< one unit of x is as long as one unit of y: for shapes in space
  std::vector<ChartLabel> labels;
};

/// @throws Error, naming the series, unless at least one series has points, each has as many x as y, all are finite
///         (above 0 on a logarithmic axis), and each has a line or markers. Labels are checked in the same way.
void check_chart(const Chart& chart);

}  // namespace holotrace
