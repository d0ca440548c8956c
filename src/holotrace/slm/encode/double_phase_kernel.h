#pragma once

// A pixel of a double-phase hologram, in the common language of C++ and OpenCL C. The loop of sample_loops.cpp says the
// same in vectors; a test compares both.

#ifdef __OPENCL_VERSION__
#define HOLOTRACE_KERNEL_FUNCTION
#else
#include <cmath>
#define HOLOTRACE_KERNEL_FUNCTION inline
namespace holotrace::double_phase_kernel {
using std::fmax;
using std::fmin;
using std::sqrt;
#endif

/// A complex number.
typedef struct {
  float re, im;
} PixelPhasor;

/// The sign of the second term at a pixel: + where column + row is even.
HOLOTRACE_KERNEL_FUNCTION int chessboard_sign(int column, int row) { return (column + row) % 2 == 0 ? 1 : -1; }

/// exp(i·arg U)·(a ± i√(1 − a²)), a = |U| but at most 1. Phase 0 for a sample of 0.
HOLOTRACE_KERNEL_FUNCTION PixelPhasor double_phase_pixel(PixelPhasor u, int sign) {
  const float modulus = sqrt(u.re * u.re + u.im * u.im), a = fmin(modulus, 1.0f);
  const float aside = sign * sqrt(fmax(1 - a * a, 0.0f));
  const float x = modulus > 0 ? u.re / modulus : 1, y = modulus > 0 ? u.im / modulus : 0;
  PixelPhasor shown;
  shown.re = x * a - y * aside;
  shown.im = y * a + x * aside;
  return shown;
}

#ifndef __OPENCL_VERSION__
}  // namespace holotrace::double_phase_kernel
#endif
#undef HOLOTRACE_KERNEL_FUNCTION
