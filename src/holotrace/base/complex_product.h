#pragma once

#include <complex>

namespace holotrace {

/// The product without the special cases of infinities that the operator has, which keep loops from being vectorised.
template <class Real>
inline std::complex<Real> product(std::complex<Real> a, std::complex<Real> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// i·z.
template <class Real>
inline std::complex<Real> times_i(std::complex<Real> z) {
  return {-z.imag(), z.real()};
}

}  // namespace holotrace
