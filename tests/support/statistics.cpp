#include "support/statistics.h"

#include <algorithm>

namespace holotrace {

double chi_square_tail(double statistic, int degrees_of_freedom) {
  const double a = 0.5 * degrees_of_freedom, x = 0.5 * statistic;
  if (!(x > 0)) return 1;
  const double scale = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {  // 1 − P by its series
    double term = 1 / a, sum = term;
    for (int n = 1; n < 10000 && term > 1e-16 * sum; ++n) sum += term *= x / (a + n);
    return 1 - scale * sum;
  }
  // Q by its continued fraction (Lentz).
  double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int n = 1; n < 10000; ++n) {
    const double an = -n * (n - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    h *= c * d;
    if (std::fabs(c * d - 1) < 1e-15) break;
  }
  return scale * h;
}

double sidak_level(double level, int tests) { return -std::expm1(std::log1p(-level) / tests); }

ChiSquare chi_square(std::span<const double> observed, std::span<const double> expected) {
  ChiSquare result;
  double rest_observed = 0, rest_expected = 0;
  int cells = 0;
  const auto add = [&](double o, double e) {
    result.statistic += (o - e) * (o - e) / e;
    ++cells;
  };
  for (size_t i = 0; i < observed.size(); ++i)
    if (expected[i] >= 5) {
      add(observed[i], expected[i]);
    } else {
      rest_observed += observed[i];
      rest_expected += expected[i];
    }
  if (rest_expected >= 5)
    add(rest_observed, rest_expected);
  else if (rest_observed > rest_expected + 25)  // a Poisson number of mean 5 exceeds 30 once in 1e13
    result.statistic = HUGE_VAL;
  result.degrees_of_freedom = std::max(1, cells - 1);
  result.p_value = std::isfinite(result.statistic) ? chi_square_tail(result.statistic, result.degrees_of_freedom) : 0;
  return result;
}

Vec3 SphereMap::direction(Vec2 square) const {
  const double t = c_ * square.x / (1 + c_ - square.x), cosine = 1 - 2 * t;
  const double sine = 2 * std::sqrt(std::fmax(0, t * (1 - t))), angle = 2 * pi * square.y;
  return transform_vector(frame_, {sine * std::cos(angle), sine * std::sin(angle), cosine});
}

Vec2 SphereMap::square(Vec3 direction) const {
  const Vec3 offset = direction - frame_.z;
  const double t = std::fmin(1, dot(offset, offset) / 4);  // (1 − cosθ)/2 without cancellation
  const double angle = std::atan2(dot(direction, frame_.y), dot(direction, frame_.x)) / (2 * pi);
  return {t * (1 + c_) / (c_ + t), angle < 0 ? angle + 1 : angle};
}

}  // namespace holotrace
