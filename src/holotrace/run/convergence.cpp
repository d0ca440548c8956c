#include "holotrace/run/convergence.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace holotrace {

bool has_convergence(const Report& report) {
  return std::any_of(report.stages.begin(), report.stages.end(), [](const StageReport& stage) {
    return std::any_of(stage.curves.begin(), stage.curves.end(),
                       [](const auto& c) { return c.first == "convergence"; });
  });
}

Chart convergence_chart(const Report& report) {
  Chart chart;
  chart.title = "Convergence";
  chart.x_label = "iteration";
  chart.y_label = "squared error / target power [dB]";
  for (const StageReport& stage : report.stages)
    for (const auto& [name, values] : stage.curves) {
      if (name != "convergence") continue;
      Series series;
      series.name = stage.stage;
      for (size_t i = 0; i < values.size(); ++i) {
        if (values[i] <= 0) continue;  // has no place on a scale of decibels
        series.x.push_back(double(i));
        series.y.push_back(10 * std::log10(values[i]));
      }
      if (!series.x.empty()) chart.series.push_back(std::move(series));
    }
  return chart;
}

}  // namespace holotrace
