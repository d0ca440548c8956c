#pragma once

#include <vector>

#include "holotrace/calibrate/fit_panel.h"
#include "holotrace/calibrate/least_squares.h"

namespace holotrace {

/// The fitted unknowns as a panel and as measured values with standard errors; without the photographs.
/// @param assumed  the panel as it was assumed to be
PanelFit measured_panel(const CalibrationBench& bench, const Slm& assumed, const Unknowns& unknowns,
                        const FitResult& result);

/// Values that never fall, nearest to the given ones by least squares (pool adjacent violators).
std::vector<double> never_falling(const std::vector<double>& values);

/// Values at all levels 0 … levels − 1 from values at some: piecewise cubic, monotone where the values are (Fritsch and
/// Butland, SIAM J. Sci. Stat. Comput. 5, 300 (1984)). Beyond the last given level the last slope goes on.
std::vector<double> at_all_levels(const std::vector<int>& levels, const std::vector<double>& values, int count);

}  // namespace holotrace
