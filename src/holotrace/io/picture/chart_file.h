#pragma once

#include <string>

#include "holotrace/data/chart.h"

namespace holotrace {

/// Draws a chart as `.png` (1200 × 800 pixels) or `.svg`, with the program gnuplot (Williams, Kelley et al.), which
/// runs as a separate process. The colours are those of Okabe and Ito, which colour-blind readers can distinguish. The
/// same chart gives the same bytes.
/// @throws Error for another extension, where check_chart and write_atomically throw, if gnuplot is not installed,
///         and, with gnuplot's message, if it fails
void save_chart(const std::string& path, const Chart& chart);

}  // namespace holotrace
