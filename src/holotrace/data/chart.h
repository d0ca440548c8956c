#pragma once

#include <string>
#include <vector>

namespace holotrace {

/// One line or set of points of a chart.
struct Series {
  std::string name;  ///< in the key; "": none
  std::vector<double> x, y;
  bool has_markers = false;  ///< points, beside the line
  bool has_line = true;
};

/// A picture of curves: what sweeps and convergence are drawn with. Labels carry their units: "distance [mm]".
struct Chart {
  std::string title, x_label, y_label;
  std::vector<Series> series;
  bool is_log_x = false, is_log_y = false;
};

/// @throws Error, naming the series, unless there is one with points, as many x as y, all finite, and above 0 on a
///         logarithmic axis
void check_chart(const Chart& chart);

}  // namespace holotrace
