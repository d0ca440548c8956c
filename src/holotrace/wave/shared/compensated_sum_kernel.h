#pragma once

// Sums of many floats, in the common language of C++ and OpenCL C.

#ifdef __OPENCL_VERSION__
#define HOLOTRACE_KERNEL_FUNCTION
#else
#define HOLOTRACE_KERNEL_FUNCTION inline
namespace holotrace {
#endif

/// A sum, and what its last rounding added to it. It begins as {0, 0}.
typedef struct {
  float sum, excess;
} CompensatedSum;

/// The sum with one more term (Kahan, Comm. ACM 8, 40, 1965). Of N terms of one sign it is within (2 + N·2⁻²⁴)·2⁻²⁴ of the
/// exact one; a plain sum is within N·2⁻²⁴.
HOLOTRACE_KERNEL_FUNCTION CompensatedSum with_term(CompensatedSum so_far, float term) {
  const float wanted = term - so_far.excess, next = so_far.sum + wanted;
  so_far.excess = (next - so_far.sum) - wanted;
  so_far.sum = next;
  return so_far;
}

#ifndef __OPENCL_VERSION__
}  // namespace holotrace
#endif
#undef HOLOTRACE_KERNEL_FUNCTION
