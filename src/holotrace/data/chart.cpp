#include "holotrace/data/chart.h"

#include <cmath>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

std::string name_of(const Chart& chart, size_t n) {
  const std::string& name = chart.series[n].name;
  return fmt::format("series {}{} of the chart \"{}\"", n + 1, name.empty() ? "" : " \"" + name + "\"", chart.title);
}

void check_coordinate(double value, bool is_log, const char* axis, const std::string& where) {
  require(std::isfinite(value), "expected finite {} in {}, got {}; leave out what has no value", axis, where, value);
  require(!is_log || value > 0, "expected {} above 0 in {}, whose axis is logarithmic, got {}", axis, where, value);
}

}  // namespace

void check_chart(const Chart& chart) {
  bool has_points = false;
  for (size_t n = 0; n < chart.series.size(); ++n) {
    const Series& s = chart.series[n];
    require(s.x.size() == s.y.size(), "expected as many x as y in {}, got {} and {}", name_of(chart, n), s.x.size(),
            s.y.size());
    require(s.has_line || s.has_markers, "expected a line or markers in {}, got neither", name_of(chart, n));
    for (size_t i = 0; i < s.x.size(); ++i) {
      const std::string where = fmt::format("point {} of {}", i + 1, name_of(chart, n));
      check_coordinate(s.x[i], chart.is_log_x, "x", where);
      check_coordinate(s.y[i], chart.is_log_y, "y", where);
    }
    has_points |= !s.x.empty();
  }
  require(has_points, "expected a chart with points to draw, got \"{}\" without any", chart.title);
  for (const ChartLabel& label : chart.labels) {
    const std::string where = fmt::format("the label \"{}\" of the chart \"{}\"", label.text, chart.title);
    check_coordinate(label.x, chart.is_log_x, "x", where);
    check_coordinate(label.y, chart.is_log_y, "y", where);
  }
}

}  // namespace holotrace
