#pragma once

// Where a sample lies in memory, in the common language of C++ and OpenCL C.

#ifdef __OPENCL_VERSION__
#define HOLOTRACE_KERNEL_FUNCTION
#else
#include <cstddef>
#define HOLOTRACE_KERNEL_FUNCTION inline
namespace holotrace {
using std::size_t;
#endif

/// The place of a sample among rows of so many columns. It may be beyond 2³¹, where an int ends: a field of 65,536 × 65,536
/// samples has 2³².
HOLOTRACE_KERNEL_FUNCTION size_t sample_place(int column, int row, int columns) {
  return (size_t)row * (size_t)columns + (size_t)column;
}

#ifndef __OPENCL_VERSION__
}  // namespace holotrace
#endif
#undef HOLOTRACE_KERNEL_FUNCTION
