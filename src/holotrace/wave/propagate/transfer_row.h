#pragma once

#include <complex>
#include <cstddef>

namespace holotrace {

/// The transfer function of free space (propagation_kernel.h) for one u and many v, in single precision:
///
///     to[i] = exp(2πi·(start − z·q/(k + √(k² − q)))),   q = u² + v2[i],  k = 1/λ
///
/// Cycles are computed in double and their fraction is rounded to float: within 4e-7 of the exact value. Compiled for
/// every instruction set. There must be no evanescent wave: q ≤ k².
struct TransferRow {
  double u2, k, z, start;  ///< u² [1/m²], 1/λ [1/m], z [m], axial phase [cycles]
};
void transfer_row(const TransferRow& row, const double* v2, size_t count, std::complex<float>* to);

/// The Rayleigh–Sommerfeld kernel (propagation_kernel.h) at one y and many x, times a factor, in double precision.
struct KernelRow {
  double y, wavelength, z;  ///< [m]
  double start;             ///< cycle_fraction(|z|, λ)
  double scale;
};
void rayleigh_sommerfeld_row(const KernelRow& row, const double* x, size_t count, std::complex<double>* to);

}  // namespace holotrace
