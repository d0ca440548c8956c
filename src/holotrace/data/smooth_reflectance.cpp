#include "holotrace/data/smooth_reflectance.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "holotrace/data/cie.h"

namespace holotrace {
namespace {

constexpr double middle = (shortest_visible + longest_visible) / 2, half = (longest_visible - shortest_visible) / 2;
constexpr int steps = 81;         // 5 nm
constexpr double darkest = 1e-4;  // black and white are the limits of infinite coefficients

double place_of(double wavelength) { return std::clamp((wavelength - middle) / half, -1.0, 1.0); }

double sigmoid(double x) { return 0.5 + x / (2 * std::sqrt(1 + x * x)); }

// Colours in daylight of a surface that reflects one step of the spectrum; together they are white.
const std::array<Vec3, steps>& colours_of_steps() {
  static const std::array<Vec3, steps> colours = [] {
    const Vec3 factors = daylight_factors(d65_chromaticity);
    std::array<Vec3, steps> parts;
    Vec3 white;
    for (int i = 0; i < steps; ++i) {
      const double wavelength = (380 + 5 * i) * 1e-9;
      parts[size_t(i)] = srgb_from_xyz(colour_matching(wavelength)) * dot(daylight_components(wavelength), factors);
      white += parts[size_t(i)];
    }
    for (Vec3& part : parts) part = {part.x / white.x, part.y / white.y, part.z / white.z};
    return parts;
  }();
  return colours;
}

double place_of_step(int i) { return -1 + 2.0 * i / (steps - 1); }

}  // namespace

double SmoothReflectance::at(double wavelength) const {
  const double t = place_of(wavelength);
  return sigmoid(c0 + t * (c1 + t * c2));
}

Vec3 SmoothReflectance::colour() const {
  Vec3 sum;
  for (int i = 0; i < steps; ++i) {
    const double t = place_of_step(i);
    sum += colours_of_steps()[size_t(i)] * sigmoid(c0 + t * (c1 + t * c2));
  }
  return sum;
}

SmoothReflectance fit_reflectance(Vec3 rgb) {
  const auto inside = [](double value) { return std::clamp(value, darkest, 1 - darkest); };
  const Vec3 wanted{inside(rgb.x), inside(rgb.y), inside(rgb.z)};
  const double grey = (wanted.x + wanted.y + wanted.z) / 3;
  SmoothReflectance best{(grey - 0.5) / std::sqrt(grey * (1 - grey)), 0, 0};
  const auto error_of = [&](const SmoothReflectance& spectrum) { return spectrum.colour() - wanted; };
  Vec3 error = error_of(best);
  double damping = 1e-3;
  for (int step = 0; step < 200 && dot(error, error) > 1e-14; ++step) {
    Eigen::Matrix3d slopes = Eigen::Matrix3d::Zero();  // of the colour, by the coefficients
    for (int i = 0; i < steps; ++i) {
      const double t = place_of_step(i), x = best.c0 + t * (best.c1 + t * best.c2);
      const double slope = 0.5 / std::pow(1 + x * x, 1.5);
      const Vec3 part = colours_of_steps()[size_t(i)] * slope;
      const Eigen::Vector3d column(part.x, part.y, part.z);
      slopes.col(0) += column;
      slopes.col(1) += column * t;
      slopes.col(2) += column * (t * t);
    }
    const Eigen::Matrix3d squared = slopes.transpose() * slopes;
    Eigen::Matrix3d damped = squared;
    damped.diagonal() += damping * squared.diagonal() + Eigen::Vector3d::Constant(1e-300);
    const Eigen::Vector3d change = damped.ldlt().solve(slopes.transpose() * Eigen::Vector3d(error.x, error.y, error.z));
    const SmoothReflectance next{best.c0 - change[0], best.c1 - change[1], best.c2 - change[2]};
    const Vec3 next_error = error_of(next);
    if (dot(next_error, next_error) < dot(error, error)) {
      best = next;
      error = next_error;
      damping = std::max(1e-12, damping / 4);
    } else {
      damping *= 8;
      if (damping > 1e12) break;
    }
  }
  return best;
}

}  // namespace holotrace
