#pragma once

#include <complex>

namespace holotrace {

/// The product a·b without the special cases for infinities of the operator, which prevent vectorization.
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
