#pragma once

#include <complex>
#include <cstddef>

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

// Loops over arrays of complex numbers, for every instruction set. Two arrays are the same or do not overlap.

/// to[i] = a[i]·b[i]
template <class Real>
void multiply(std::complex<Real>* to, const std::complex<Real>* a, const std::complex<Real>* b, size_t count);

/// to[i] += a[i]·b[i]
template <class Real>
void multiply_add(std::complex<Real>* to, const std::complex<Real>* a, const std::complex<Real>* b, size_t count);

/// to[i] = a[i]·conj(b[i])
template <class Real>
void multiply_conjugate(std::complex<Real>* to, const std::complex<Real>* a, const std::complex<Real>* b, size_t count);

/// to[i] += a[i]·conj(b[i])
template <class Real>
void multiply_conjugate_add(std::complex<Real>* to, const std::complex<Real>* a, const std::complex<Real>* b,
                            size_t count);

/// to[row][i] = a[row][i]·factor[row], i < width
template <class Real>
void multiply_rows(std::complex<Real>* to, const std::complex<Real>* a, const std::complex<Real>* factor, size_t rows,
                   size_t width);

/// to[row][i] += a[row][i]·factor[row], i < width
template <class Real>
void multiply_add_rows(std::complex<Real>* to, const std::complex<Real>* a, const std::complex<Real>* factor,
                       size_t rows, size_t width);

/// Σ|a[i]|², in double.
template <class Real>
double energy(const std::complex<Real>* a, size_t count);

}  // namespace holotrace
