#include "holotrace/data/measured_brdf.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/units.h"

namespace holotrace {
namespace {

double mean_of(const MeasuredField& table, int h, int d, int p) {
  return (merl_value(table, 0, h, d, p) + merl_value(table, 1, h, d, p) + merl_value(table, 2, h, d, p)) / 3;
}

// The angle of the half vector in the middle of a cell [rad].
double theta_h_of(double cell) { return (cell + 0.5) * (cell + 0.5) / (merl_theta_h * merl_theta_h) * (pi / 2); }

}  // namespace

void choose_lobe(MeasuredBrdf& brdf) {
  const MeasuredField& table = brdf.fields.front();
  constexpr int near = 10, across = merl_phi_d / 2;  // θ_d of 10°
  double least = mean_of(table, 0, near, across);
  for (int h = 0; h < merl_theta_h * 3 / 4; ++h) least = std::min(least, mean_of(table, h, near, across));
  const double peak = mean_of(table, 0, near, across) - least;
  int h = 0;
  while (h < merl_theta_h - 1 && mean_of(table, h, near, across) - least > peak / 2) ++h;
  // D falls to half at tan²θ = α²·(√2 − 1).
  brdf.alpha = std::clamp(std::tan(std::min(theta_h_of(h), 1.2)) / std::sqrt(std::sqrt(2.0) - 1), 0.01, 1.0);
  // The highlight's albedo, about ∫(f − least)·4·cosθ_h dω_h, seen from above.
  double highlight = 0;
  for (int i = 0; i < merl_theta_h / 2; ++i) {
    const double angle = theta_h_of(i), width = theta_h_of(i + 0.5) - theta_h_of(i - 0.5);
    const double value = mean_of(table, i, std::min(int(angle / (pi / 2) * merl_theta_d), merl_theta_d - 1), across);
    highlight +=
        2 * pi * std::sin(angle) * width * 4 * std::cos(angle) * std::cos(2 * angle) * std::max(0.0, value - least);
  }
  const double diffuse = pi * least;
  brdf.diffuse_share = diffuse + highlight > 0 ? std::clamp(diffuse / (diffuse + highlight), 0.1, 0.9) : 0.9;
}

}  // namespace holotrace
