#pragma once

#include <string>

#include "holotrace/data/chart.h"
#include "holotrace/data/report.h"

namespace holotrace {

/// Whether a stage of the report iterated, and told how its error fell.
bool has_convergence(const Report& report);

/// The course of every stage that iterated: its error, as a part of the wanted light, against iterations.
Chart convergence_chart(const Report& report);

class Console;

/// Draws a chart that comes beside other results: where it cannot be drawn, as where gnuplot is not installed, that is
/// a warning.
void try_save_chart(const std::string& path, const Chart& chart, Console& console);

}  // namespace holotrace
