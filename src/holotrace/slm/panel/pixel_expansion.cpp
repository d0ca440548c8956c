#include "holotrace/slm/panel/pixel_expansion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "holotrace/base/units.h"

namespace holotrace {
namespace {

constexpr int most_points = 64;

// P_n and its derivative at |t| < 1.
struct LegendreValue {
  double value, slope;
};

LegendreValue legendre(int n, double t) {
  const unsigned order = unsigned(n);
  const double value = std::legendre(order, t);
  return {value, n * (std::legendre(order - 1, t) - t * value) / (1 - t * t)};
}

}  // namespace

PixelExpansion pixel_expansion(const Slm& slm, const ShowParams& params, PixelDetail detail) {
  if (!(slm.effects.crosstalk > 0)) return {};
  if (detail == PixelDetail::mean) return {2, 1};
  const int wanted = std::clamp(params.subpixels, 0, most_points) + 2, least = slm.effects.crosstalk < 0.2 ? 8 : 4;
  const int points = params.fine_samples > 0 ? params.fine_samples : std::clamp(wanted, least, most_points);
  if (detail == PixelDetail::as_shown) return {points, std::min(points, wanted)};
  const int terms = std::min(points, wanted - 1);
  return {std::max(terms, points / 2), terms};
}

LegendrePoints::LegendrePoints(int count, int terms) {
  for (int c = 0; c < count; ++c) {
    double t = -std::cos(pi * (c + 0.75) / (count + 0.5));  // Newton's method from here finds each zero of P_count
    for (int i = 0; i < 20; ++i) {
      const LegendreValue p = legendre(count, t);
      t -= p.value / p.slope;
    }
    places.push_back(2 * c + 1 == count ? 0 : t);
  }
  for (int k = 0; k < terms; ++k)
    for (const double t : places) {
      const double slope = legendre(count, t).slope, weight = 2 / ((1 - t * t) * slope * slope);
      projections.push_back(float((k + 0.5) * weight * std::legendre(unsigned(k), t)));
    }
}

// Upwards from sin(a)/a where that is stable.
double legendre_spectrum(int term, double a) {
  const double size = std::abs(a), sign = a < 0 && term % 2 == 1 ? -1 : 1;
  if (size <= term || size < 1e-3) return sign * std::sph_bessel(unsigned(term), size);
  double last = std::cos(size) / size, now = std::sin(size) / size;  // j₋₁ and j₀
  for (int k = 0; k < term; ++k) last = std::exchange(now, (2 * k + 1) / size * now - last);
  return sign * now;
}

}  // namespace holotrace
