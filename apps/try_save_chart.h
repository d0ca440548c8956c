#pragma once

#include <string>

#include "holotrace/data/chart.h"
#include "holotrace/io/files/output_set.h"

namespace holotrace {

class Console;

/// Draws a chart that accompanies other results. If it cannot be drawn, for instance because gnuplot is not installed,
/// the console shows a warning.
void try_save_chart(const std::string& path, const Chart& chart, Console& console);

/// The same for a chart of a set of files.
void try_save_chart(const OutputSet& set, const std::string& name, const Chart& chart, Console& console);

}  // namespace holotrace
