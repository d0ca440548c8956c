#pragma once

#include <string>

#include "holotrace/data/chart.h"
#include "holotrace/data/report.h"

namespace holotrace {

/// Whether a stage of the report iterated and recorded its error.
bool has_convergence(const Report& report);

/// Chart of every stage that iterated: its error, as a fraction of the wanted light, against iterations.
Chart convergence_chart(const Report& report);

class Console;

/// Draws a chart that accompanies other results. If it cannot be drawn, for instance because gnuplot is not installed,
/// the console shows a warning.
void try_save_chart(const std::string& path, const Chart& chart, Console& console);

}  // namespace holotrace
