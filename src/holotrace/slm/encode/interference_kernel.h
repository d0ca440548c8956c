#pragma once

// A pixel of the interference of a field with a tilted plane wave, in the common language of C++ and OpenCL C. Numbers are
// doubles on the processor and floats on devices.

#ifdef __OPENCL_VERSION__
#define HOLOTRACE_KERNEL_FUNCTION
typedef float InterferenceReal;
#else
#define HOLOTRACE_KERNEL_FUNCTION inline
namespace holotrace::interference_kernel {
typedef double InterferenceReal;
#endif

/// A complex number.
typedef struct {
  InterferenceReal re, im;
} WaveSample;

/// The plane wave exp(2πi(u·x + v·y)) at a pixel, of its factors for the pixel's column and row.
HOLOTRACE_KERNEL_FUNCTION WaveSample plane_wave(WaveSample of_column, WaveSample of_row) {
  WaveSample wave;
  wave.re = of_column.re * of_row.re - of_column.im * of_row.im;
  wave.im = of_column.re * of_row.im + of_column.im * of_row.re;
  return wave;
}

/// Re(U·R*)
HOLOTRACE_KERNEL_FUNCTION InterferenceReal product_with(WaveSample reference, WaveSample u) {
  return u.re * reference.re + u.im * reference.im;
}

/// |U + ρ·R|² for |R| = 1; without bias the part 2ρ·Re(U·R*) of it.
HOLOTRACE_KERNEL_FUNCTION InterferenceReal interference(WaveSample u, WaveSample reference, InterferenceReal modulus,
                                                        int with_bias) {
  const InterferenceReal between = 2 * modulus * product_with(reference, u);
  return with_bias ? u.re * u.re + u.im * u.im + modulus * modulus + between : between;
}

#ifndef __OPENCL_VERSION__
}  // namespace holotrace::interference_kernel
#endif
#undef HOLOTRACE_KERNEL_FUNCTION
