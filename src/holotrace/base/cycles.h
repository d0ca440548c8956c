#pragma once

#include <cmath>
#include <complex>

#include "holotrace/base/units.h"

// A phase is never computed as the product k·r: lengths become cycles, whole cycles are dropped, and only the rest
// becomes an angle.

namespace holotrace {

/// exp(2πi·cycles); whole cycles are dropped before the multiplication by 2π.
inline std::complex<double> cis_cycles(double cycles) {
  return std::polar(1.0, 2 * pi * (cycles - std::floor(cycles)));
}

/// The fraction of a cycle in a length of many wavelengths, in [0, 1). Long double keeps the cycle count to a relative
/// error of 1e-19; a double would be off by up to 1e-10 of a cycle at 0.3 m.
inline double cycle_fraction(double length, double wavelength) {
  const long double cycles = (long double)length / wavelength;
  return double(cycles - std::floor(cycles));
}

}  // namespace holotrace
