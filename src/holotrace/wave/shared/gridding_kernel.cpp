#include "holotrace/wave/shared/gridding_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

// Coefficients of the polynomial in s ∈ [−½, ½] that equals f at the Chebyshev points, by divided differences.
template <class Function>
std::vector<double> interpolate(const Function& f, int degree) {
  std::vector<double> points(size_t(degree) + 1), differences(size_t(degree) + 1);
  for (int i = 0; i <= degree; ++i) {
    points[size_t(i)] = 0.5 * std::cos(pi * (i + 0.5) / (degree + 1));
    differences[size_t(i)] = f(points[size_t(i)]);
  }
  for (int order = 1; order <= degree; ++order)
    for (int i = degree; i >= order; --i)
      differences[size_t(i)] =
          (differences[size_t(i)] - differences[size_t(i - 1)]) / (points[size_t(i)] - points[size_t(i - order)]);
  std::vector<double> powers(size_t(degree) + 1, 0.0);
  for (int i = degree; i >= 0; --i) {  // Horner: powers ← powers·(s − pointᵢ) + differenceᵢ
    for (int k = degree; k > 0; --k) powers[size_t(k)] = powers[size_t(k - 1)] - points[size_t(i)] * powers[size_t(k)];
    powers[0] = differences[size_t(i)] - points[size_t(i)] * powers[0];
  }
  return powers;
}

// β/w of the least gridding_error, for widths from 2 on.
using BetaPerWidth = std::array<double, GriddingKernel::greatest_width - 1>;
constexpr BetaPerWidth of_double_grids{1.80, 2.12, 2.22, 2.27, 2.30, 2.32, 2.33},
    of_coarser_grids{1.47, 1.81, 1.94, 2.00, 2.03, 2.04, 2.06};

}  // namespace

GriddingKernel::GriddingKernel(int width, double oversampling)
    : kernel_{width, 0}, coefficients_((degree + 1) * greatest_width, 0.0f) {
  require(width >= 2 && width <= greatest_width, "expected a kernel 2 to {} cells wide, got {}", greatest_width, width);
  require(oversampling == 2 || oversampling == 1.5, "expected a grid 2 or 1.5 times as fine, got {}", oversampling);
  kernel_.beta = (oversampling == 2 ? of_double_grids : of_coarser_grids)[size_t(width - 2)] * width;
  for (int l = 0; l < width; ++l) {
    const auto powers = interpolate([&](double s) { return value(s + 0.5 - width / 2.0 + l); }, degree_of(width));
    for (int k = 0; k <= degree_of(width); ++k)
      coefficients_[size_t(k * greatest_width + l)] = float(powers[size_t(k)]);
  }
}

double SemicircleKernel::value(double x) const {
  const double z = 2 * x / width, inside = 1 - z * z;
  return inside <= 0 ? 0 : std::exp(beta * (std::sqrt(inside) - 1));
}

double SemicircleKernel::moment(int n, double xi) const {
  // With x = (w/2)·sin θ the integrand is smooth and small at the ends, so the midpoint rule converges fast. Both sides
  // of the middle give the same.
  constexpr int points = 200;
  double sum = 0;
  for (int i = points / 2; i < points; ++i) {
    const double theta = pi * ((i + 0.5) / points - 0.5), x = width / 2.0 * std::sin(theta), cosine = std::cos(theta);
    const double wave = n % 2 == 0 ? std::cos(2 * pi * xi * x) : std::sin(2 * pi * xi * x);
    double power = 1;
    for (int k = 0; k < n; ++k) power *= x;
    sum += 2 * power * std::exp(beta * (cosine - 1)) * wave * cosine;
  }
  return sum * pi / points * width / 2;
}

double GriddingKernel::weight(int l, double t) const {
  double sum = 0;
  for (int k = degree; k >= 0; --k) sum = sum * (t - 0.5) + double(coefficients(k)[l]);
  return sum;
}

namespace {

// Squared relative error of a plane wave at each output of a tile, from one end to the other.
using OutputErrors = std::array<double, 120>;

OutputErrors errors_of_outputs(int width, double oversampling) {
  const GriddingKernel kernel(width, oversampling);
  constexpr int fractions = 8;
  OutputErrors errors{};
  for (size_t i = 0; i < errors.size(); ++i) {
    const double xi = ((double(i) + 0.5) / errors.size() - 0.5) / oversampling;  // the middle of the grid's outputs
    const double scale = 1 / kernel.transform(xi);
    for (int j = 0; j < fractions; ++j) {
      const double t = (j + 0.5) / fractions;
      std::complex<double> sum = 0;
      for (int l = 0; l < width; ++l) {
        const double x = t - width / 2.0 + l;
        sum += kernel.weight(l, t) * std::polar(1.0, 2 * pi * xi * x);
      }
      errors[i] += std::norm(sum * scale - 1.0) / fractions;
    }
  }
  return errors;
}

}  // namespace

double gridding_error(int width, double oversampling, double used) {
  using Errors = std::array<OutputErrors, GriddingKernel::greatest_width + 1>;
  const auto of_widths = [](double of) {
    Errors errors{};
    for (int w = 2; w <= GriddingKernel::greatest_width; ++w) errors[size_t(w)] = errors_of_outputs(w, of);
    return errors;
  };
  static const Errors on_double_grids = of_widths(2), on_coarser_grids = of_widths(1.5);
  const OutputErrors& errors = (oversampling == 2 ? on_double_grids : on_coarser_grids)[size_t(width)];
  const size_t count = std::clamp<size_t>(size_t(std::lround(used * errors.size())), 1, errors.size());
  return std::sqrt(std::accumulate(errors.begin(), errors.begin() + count, 0.0) / double(count));
}

}  // namespace holotrace
