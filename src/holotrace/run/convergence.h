#pragma once

#include "holotrace/data/chart.h"
#include "holotrace/data/report.h"

namespace holotrace {

/// Whether a stage of the report iterated and recorded its error (the curve "convergence").
bool has_convergence(const Report& report);

/// Chart of every stage that iterated: its squared error as a fraction of the target power, in decibels (10·log₁₀),
/// against the number of the iteration. Errors of 0 have no place on that scale and are left out.
Chart convergence_chart(const Report& report);

}  // namespace holotrace
