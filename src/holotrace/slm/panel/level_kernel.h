#pragma once

// The level of a pixel that is nearest to what it should show, in the common language of C++ and OpenCL C. Numbers are
// doubles on the processor and floats on devices.

#ifdef __OPENCL_VERSION__
#define HOLOTRACE_KERNEL_FUNCTION
typedef float LevelReal;
#else
#include <cmath>
#define HOLOTRACE_KERNEL_FUNCTION inline
namespace holotrace::level_kernel {
using std::fabs;
using std::floor;
using std::fmax;
using std::fmin;
typedef double LevelReal;
#endif

/// The level of M whose phase range·ℓ/M is nearest, around the circle, to a phase in [0, 1], both in turns, among the
/// levels of the first turn. Levels beyond one turn (range > 1) are not used. If the levels do not reach one turn, phases in
/// the gap get the nearer end.
HOLOTRACE_KERNEL_FUNCTION int nearest_phase_level(LevelReal turns, int levels, LevelReal range) {
  const LevelReal middle = (LevelReal)1 / 2;
  const LevelReal nearest = fmin(floor(turns * levels / range + middle), (LevelReal)(levels - 1));
  const LevelReal off = fabs(turns - range * nearest / levels);
  return 1 - turns <= off ? 0 : (int)nearest;
}

/// The level of M whose transmittance ℓ/(M−1) is nearest; transmittances beyond [0, 1] are clipped.
HOLOTRACE_KERNEL_FUNCTION int nearest_amplitude_level(LevelReal transmittance, int levels) {
  const LevelReal none = 0, all = 1, middle = (LevelReal)1 / 2;
  return (int)floor(fmin(fmax(transmittance, none), all) * (levels - 1) + middle);
}

#ifndef __OPENCL_VERSION__
}  // namespace holotrace::level_kernel
#endif
#undef HOLOTRACE_KERNEL_FUNCTION
