#pragma once

#include "holotrace/data/field.h"
#include "holotrace/data/target.h"
#include "holotrace/slm/encode/iterate/iteration_kernels.h"

// Sums over a target plane: within a row in float, over rows in double and in order; the same on any number of threads.

namespace holotrace {

/// Σw·a².
double target_power(const TargetPlane& target);

/// Σw·a·|v| and Σw·|v|².
ModulusSums fit_sums(const TargetPlane& target, const Field& shown);

/// Σw·(|v| − s·a)².
double modulus_error(const TargetPlane& target, const Field& shown, double scale);

/// As modulus_error; the field becomes its residual w·(s·a − |v|)·v/|v|.
double leave_residual(const TargetPlane& target, double scale, Field& shown);

/// to ← to + factor·from, or factor·from where `to` has no samples yet.
void add_part(const Field& from, double factor, Field& to);

/// The largest a where w is not 0: the peak of the PSNR.
double target_peak(const TargetPlane& target);

}  // namespace holotrace
