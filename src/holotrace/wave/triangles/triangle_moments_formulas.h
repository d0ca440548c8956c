// Included by triangle_moments.h and, inside the namespace of each instruction set, by triangle_tile.cpp. Therefore it
// has no include guard and no namespace of its own. The formulas are explained in triangle_moments.h.

/// A complex number over any type of real number.
template <class Real>
struct Phasor {
  Real re, im;
};
template <class Real>
inline Phasor<Real> operator+(const Phasor<Real>& a, const Phasor<Real>& b) {
  return {a.re + b.re, a.im + b.im};
}
template <class Real>
inline Phasor<Real> operator-(const Phasor<Real>& a, const Phasor<Real>& b) {
  return {a.re - b.re, a.im - b.im};
}
template <class Real>
inline Phasor<Real> operator*(const Phasor<Real>& a, const Phasor<Real>& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
template <class Real>
inline Phasor<Real> operator*(const Phasor<Real>& a, const Real& s) {
  return {a.re * s, a.im * s};
}
/// a/(i·g) = −i·a/g, for s = 1/g.
template <class Real>
inline Phasor<Real> over_i(const Phasor<Real>& a, const Real& s) {
  return {a.im * s, -(a.re * s)};
}

/// Integrals over the simplex (of area 1/2): mᵢ of tᵢ·exp(i·Σ tⱼθⱼ), mᵢⱼ of tᵢtⱼ·exp(i·Σ tⱼθⱼ).
template <class Real>
struct TriangleMoments {
  Phasor<Real> m0, m1, m2, m01, m12, m02;
};

/// Integrals of a factor times exp(i·phase) over an edge, t from 0 to 1: factors 1, 1 − t, t and t(1 − t), in this
/// order.
template <class Real>
struct EdgeMoments {
  Phasor<Real> one, first, last, both;
};

/// Uses h, half the gap of phase: j₀ = sin h/h and j₁/h = (sin h − h·cos h)/h³, by their series for h² < 0.5.
template <class Real>
inline EdgeMoments<Real> edge_moments(const Real& from, const Real& to) {
  const Real h = (to - from) * real(from, 0.5), h2 = h * h;
  Real c, s, mean_re, mean_im;
  cis_of(h, c, s);
  cis_of(from + h, mean_re, mean_im);
  const auto next = [&](const Real& sum, double a) { return sum * h2 + real(h, a); };
  const auto series = [&](double a0, double a1, double a2, double a3, double a4, double a5, double a6) {
    return next(next(next(next(next(next(real(h, a6), a5), a4), a3), a2), a1), a0);
  };
  // Σ (−1)ⁿh²ⁿ/(2n+1)!  and  Σ (−1)ⁿh²ⁿ·2(n+1)/(2n+3)!
  const Real j0_small = series(1, -1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880, -1.0 / 39916800, 1.0 / 6227020800);
  const Real j1_small =
      series(1.0 / 3, -1.0 / 30, 1.0 / 840, -1.0 / 45360, 1.0 / 3991680, -1.0 / 518918400, 1.0 / 93405312000);
  const Real safe = small_or(h2, real(h, 1), h);  // avoids a division by 0 where the series is used
  const Real inverse = real(h, 1) / safe;
  const Real j0_large = s * inverse;
  const Real j0 = small_or(h2, j0_small, j0_large);
  const Real j1_over_h = small_or(h2, j1_small, (j0_large - c) * inverse * inverse);
  const Real half_j0 = j0 * real(h, 0.5), half_j1 = j1_over_h * h * real(h, 0.5);
  const Phasor<Real> mean{mean_re, mean_im};
  return {mean * j0, mean * Phasor<Real>{half_j0, -half_j1}, mean * Phasor<Real>{half_j0, half_j1},
          mean * (j1_over_h * real(h, 0.5))};
}

/// Moments by quotients. θ₀ and θ₂ must be the farthest apart, by 1 rad or more.
template <class Real>
inline TriangleMoments<Real> moments_by_quotients(const Real& t0, const Real& t1, const Real& t2) {
  const EdgeMoments<Real> a = edge_moments(t0, t1), b = edge_moments(t1, t2);
  const Real s = real(t0, 1) / (t0 - t2);
  const Phasor<Real> whole = over_i(a.one - b.one, s);
  TriangleMoments<Real> m;
  m.m0 = over_i(a.first - whole, s);
  m.m1 = over_i(a.last - b.first, s);
  m.m2 = over_i(whole - b.last, s);
  m.m01 = over_i(a.both - m.m1, s);
  m.m12 = over_i(m.m1 - b.both, s);
  m.m02 = over_i(m.m0 - m.m2, s);
  return m;
}

/// Moments by a series about the mean phase. 13 terms reach a float's precision for gaps up to 3.2 rad, 18 terms a
/// double's up to 1.5 rad.
template <int terms, class Real>
inline TriangleMoments<Real> moments_by_series(const Real& t0, const Real& t1, const Real& t2) {
  const Real mean = (t0 + t1 + t2) * real(t0, 1.0 / 3);
  const Real x = t0 - mean, y = t1 - mean, z = t2 - mean;  // x + y + z = 0
  const Real e2 = x * y + y * z + z * x, e3 = x * y * z, zero = real(x, 0);
  Real back1 = zero, back2 = zero, back3 = zero;  // complete homogeneous polynomials h of x, y, z, by Newton's identity
  Real h0 = zero, h1 = zero, h2 = zero, h01 = zero, h12 = zero, h02 = zero;  // h with x, y, z, (x, y), … repeated
  Real sums[6][2] = {{zero, zero}, {zero, zero}, {zero, zero}, {zero, zero}, {zero, zero}, {zero, zero}};
  double factorial = 2;  // (k + 2)!
#pragma GCC unroll 18
  for (int k = 0; k < terms; ++k) {
    const Real h = k == 0 ? real(x, 1) : e3 * back3 - e2 * back2;
    back3 = back2;
    back2 = back1;
    back1 = h;
    h0 = h + x * h0;
    h1 = h + y * h1;
    h2 = h + z * h2;
    h01 = h0 + y * h01;
    h12 = h1 + z * h12;
    h02 = h0 + z * h02;
    factorial *= k + 3;  // (k + 3)!; the sign follows iᵏ
    const double sign = (k & 2) ? -1 : 1, one = sign / factorial, two = one / (k + 4);
    const int part = k & 1;
    sums[0][part] = sums[0][part] + h0 * real(x, one);
    sums[1][part] = sums[1][part] + h1 * real(x, one);
    sums[2][part] = sums[2][part] + h2 * real(x, one);
    sums[3][part] = sums[3][part] + h01 * real(x, two);
    sums[4][part] = sums[4][part] + h12 * real(x, two);
    sums[5][part] = sums[5][part] + h02 * real(x, two);
  }
  Phasor<Real> turn;
  cis_of(mean, turn.re, turn.im);
  const auto turned = [&](int i) { return Phasor<Real>{sums[i][0], sums[i][1]} * turn; };
  return {turned(0), turned(1), turned(2), turned(3), turned(4), turned(5)};
}

/// Light that a triangle sends to one place, corners ordered by `order_corners`: Σ aᵢ·mᵢ + 4·Σ bᵢⱼ·mᵢⱼ.
template <class Real>
inline Phasor<Real> combine(const TriangleMoments<Real>& m, const Real a[3], const Phasor<Real> b[3]) {
  return m.m0 * a[0] + m.m1 * a[1] + m.m2 * a[2] + (m.m01 * b[0] + m.m12 * b[1] + m.m02 * b[2]) * real(a[0], 4);
}
