#pragma once

#include "holotrace/calibrate/fit_panel.h"
#include "holotrace/data/chart.h"

namespace holotrace {

/// The phase of each level: assumed, measured with its standard errors, and as written to the panel file.
Chart curve_chart(const PanelFit& fit);

/// The rms difference between each photograph and its simulation.
Chart residual_chart(const PanelFit& fit);

}  // namespace holotrace
