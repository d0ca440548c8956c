#pragma once

#include <array>
#include <cmath>
#include <complex>

// Jones calculus: fully polarised light as a vector of two complex amplitudes, and what polarisers, wave plates and liquid
// crystals do to it as 2 × 2 matrices. Axes are fixed: x right, y up as the viewer sees the panel, also behind a mirror. The time
// factor is exp(−iωt), so light that is delayed by δ gets exp(+iδ). Angles are from x toward y, angles and delays in radians.
//
// Reference: R. C. Jones, A new calculus for the treatment of optical systems, J. Opt. Soc. Am. 31, 488 (1941);
// P. Yeh, C. Gu, Optics of Liquid Crystal Displays, 2nd ed., Wiley 2010, chapter 4.

namespace holotrace::jones {

using Complex = std::complex<double>;

/// Amplitudes of the electric field along x and y.
struct Vector {
  Complex x, y;
};

struct Matrix {
  Complex xx = 1, xy = 0, yx = 0, yy = 1;
};

inline Vector operator*(const Matrix& m, const Vector& v) { return {m.xx * v.x + m.xy * v.y, m.yx * v.x + m.yy * v.y}; }

inline Matrix operator*(const Matrix& a, const Matrix& b) {
  return {a.xx * b.xx + a.xy * b.yx, a.xx * b.xy + a.xy * b.yy, a.yx * b.xx + a.yy * b.yx, a.yx * b.xy + a.yy * b.yy};
}

inline Matrix transpose(const Matrix& m) { return {m.xx, m.yx, m.xy, m.yy}; }

/// conj(a)·b: the amplitude that a polariser for `a` passes of `b`, if `a` has length 1.
inline Complex dot(const Vector& a, const Vector& b) { return std::conj(a.x) * b.x + std::conj(a.y) * b.y; }

/// Light of irradiance 1, linearly polarised along an axis.
inline Vector linear(double axis) { return {std::cos(axis), std::sin(axis)}; }

/// The polarisation orthogonal to `v`, of the same irradiance.
inline Vector orthogonal(const Vector& v) { return {-std::conj(v.y), std::conj(v.x)}; }

/// The coordinates in axes turned by `angle`.
inline Matrix rotation(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c, s, -s, c};
}

/// An element that is given in axes turned by `angle`.
inline Matrix turned(const Matrix& element, double angle) { return rotation(-angle) * element * rotation(angle); }

/// A retarder: light along its slow axis gets exp(iδ), light across it stays as it is.
inline Matrix retarder(double axis, double delay) { return turned({std::polar(1.0, delay), 0, 0, 1}, axis); }

/// One pass through a twisted nematic crystal, whose director turns evenly by α from its angle at the entrance, and delays light along
/// it by 2β in all:
///
///     J = R(−α)·[[cos γ + iβ/γ·sin γ, α/γ·sin γ], [−α/γ·sin γ, cos γ − iβ/γ·sin γ]]·exp(iβ),   γ² = α² + β²
///
/// in the axes of the director at the entrance; R is `rotation`. Without twist it is retarder(director, 2β). Exact for light along
/// the panel's axis, without reflections inside the crystal and with an even twist.
///
/// Reference: Yeh and Gu, section 4.3, with the time factor exp(+iωt).
inline Matrix twisted_cell(double director, double twist, double delay) {
  const double beta = delay / 2, gamma = std::hypot(twist, beta);
  const double sinc = gamma > 0 ? std::sin(gamma) / gamma : 1, cos = std::cos(gamma);
  const Complex aside(0, beta * sinc), all = std::polar(1.0, beta);
  const Matrix cell{all * (cos + aside), all * twist * sinc, -all * twist * sinc, all * (cos - aside)};
  return turned(rotation(-twist) * cell, director);
}

/// A crystal in front of a mirror, seen in fixed axes: light passes it forward and then backward, which in a medium without
/// magnetism is the transposed matrix.
inline Matrix reflected(const Matrix& pass) { return transpose(pass) * pass; }

/// The Stokes parameters (I, Q, U, V): V > 0 if, in this time factor, the y component is a quarter of a wave behind, so that the field
/// turns from x toward y.
inline std::array<double, 4> stokes(const Vector& v) {
  const Complex cross = std::conj(v.x) * v.y;
  return {std::norm(v.x) + std::norm(v.y), std::norm(v.x) - std::norm(v.y), 2 * cross.real(), 2 * cross.imag()};
}

}  // namespace holotrace::jones
