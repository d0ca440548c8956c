#include "holotrace/calibrate/charts.h"

namespace holotrace {

Chart curve_chart(const PanelFit& fit) {
  Chart chart{"Phase of each level", "level", "phase [rad]", {}, false, false, false, {}};
  Series curve{"fitted curve", {}, {}}, measured{"measured levels", {}, {}, true, false},
      assumed{"assumed before", {}, {}};
  assumed.is_dashed = true;
  const std::vector<CalibrationPoint>& points = fit.slm.effects.calibration;
  for (size_t level = 0; level < points.size(); ++level) {
    curve.x.push_back(double(level));
    curve.y.push_back(points[level].phase);
  }
  std::vector<Series> bars;
  for (const MeasuredLevel& level : fit.levels) {
    measured.x.push_back(level.level);
    measured.y.push_back(level.phase.value);
    assumed.x.push_back(level.level);
    assumed.y.push_back(level.assumed_phase);
    Series bar{"",
               {double(level.level), double(level.level)},
               {level.phase.value - level.phase.error, level.phase.value + level.phase.error}};
    bar.colour = 1;
    bars.push_back(bar);
  }
  chart.series = {curve, measured, assumed};
  chart.series.insert(chart.series.end(), bars.begin(), bars.end());
  return chart;
}

Chart residual_chart(const PanelFit& fit) {
  Chart chart{"Photographs against the fitted panel",
              "photograph",
              "rms difference, of the mean light",
              {},
              false,
              false,
              false,
              {}};
  Series rms{"", {}, {}, true, false};
  for (size_t n = 0; n < fit.photographs.size(); ++n) {
    rms.x.push_back(double(n + 1));
    rms.y.push_back(fit.photographs[n].residual);
  }
  chart.series = {rms};
  return chart;
}

}  // namespace holotrace
