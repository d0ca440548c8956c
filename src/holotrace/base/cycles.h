#pragma once

#include <cmath>
#include <complex>

#include "holotrace/base/units.h"

// Phase never passes through a number as k·r: lengths become cycles, whole cycles are dropped, and only the rest is
// an angle.

namespace holotrace {

/// exp(2πi·cycles), reduced before it is scaled.
inline std::complex<double> cis_cycles(double cycles) {
  return std::polar(1.0, 2 * pi * (cycles - std::floor(cycles)));
}

/// The fraction of a cycle in a length of many wavelengths, in [0, 1). Long double keeps 1e-19 of
/// the cycle count, where a double keeps 1e-10 of a cycle at 0.3 m.
inline double cycle_fraction(double length, double wavelength) {
  const long double cycles = (long double)length / wavelength;
  return double(cycles - std::floor(cycles));
}

}  // namespace holotrace
