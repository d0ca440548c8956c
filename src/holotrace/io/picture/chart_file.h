#pragma once

#include <string>

#include "holotrace/base/observer.h"
#include "holotrace/data/chart.h"
#include "holotrace/io/files/output_set.h"

namespace holotrace {

/// Draws a chart as `.png` (1200 × 800 pixels) or `.svg`, with the program gnuplot (Williams, Kelley et al.), which
/// runs as a separate process. The colours are those of Okabe and Ito, which colour-blind readers can distinguish. The
/// same chart gives the same bytes.
/// @throws Error for another extension, where check_chart and write_atomically throw, if gnuplot is not installed,
///         and, with gnuplot's message, if it fails
void save_chart(const std::string& path, const Chart& chart);

/// Draws a chart of a set of files that accompanies other results. Without gnuplot it is left out; if it cannot be drawn for
/// another reason, the observer is warned.
void try_save_chart(const OutputSet& set, const std::string& name, const Chart& chart, const Observer& observer);

}  // namespace holotrace
