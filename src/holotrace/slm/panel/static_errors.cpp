#include "holotrace/slm/panel/static_errors.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <vector>

#include "holotrace/base/cycles.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"

namespace holotrace {
namespace {

// A Zernike polynomial, prepared for many points: R_n^|m|(ρ)·{cos, sin}(|m|θ) is a polynomial in ρ² times the real or
// imaginary part of (x + iy)^|m|.
class Polynomial {
 public:
  Polynomial(int n, int m) : m_(m) {
    const int order = std::abs(m);
    const double norm = std::sqrt((n + 1) * (order == 0 ? 1.0 : 2.0));
    for (int s = 0; s <= (n - order) / 2; ++s)  // from the highest power of ρ² to the lowest
      coefficients_.push_back(
          norm * (s % 2 ? -1 : 1) * std::tgamma(n - s + 1) /
          (std::tgamma(s + 1) * std::tgamma((n + order) / 2 - s + 1) * std::tgamma((n - order) / 2 - s + 1)));
  }

  double operator()(double x, double y) const {
    const double square = x * x + y * y;
    double radial = 0, re = 1, im = 0;
    for (const double c : coefficients_) radial = radial * square + c;
    for (int k = 0; k < std::abs(m_); ++k) {
      const double next = re * x - im * y;
      im = re * y + im * x;
      re = next;
    }
    return radial * (m_ < 0 ? im : re);
  }

 private:
  int m_;
  std::vector<double> coefficients_;
};

}  // namespace

double zernike(int n, int m, double rho, double theta) {
  return Polynomial(n, m)(rho * std::cos(theta), rho * std::sin(theta));
}

Array2D<std::complex<float>> static_phasors(const Slm& slm, double stretch) {
  const SlmEffects& effects = slm.effects;
  if (effects.aberration.empty() && !effects.phase_map && !effects.light_map) return {};
  const Grid grid{slm.grid.nx, slm.grid.ny, slm.grid.pitch};
  const double radius = std::hypot(grid.width(), grid.height()) / 2;
  std::vector<Polynomial> polynomials;
  for (const ZernikeTerm& term : effects.aberration) polynomials.emplace_back(term.n, term.m);
  Array2D<std::complex<float>> phasors(grid.ny, grid.nx);
  parallel_for(0, grid.ny, [&](int64_t j) {
    for (int i = 0; i < grid.nx; ++i) {
      const double x = grid.x(i) / radius, y = grid.y(double(j)) / radius;
      double phase = effects.phase_map ? double((*effects.phase_map)(int(j), i)) : 0;
      for (size_t t = 0; t < polynomials.size(); ++t) phase += effects.aberration[t].rms * polynomials[t](x, y);
      const double amplitude = effects.light_map ? std::sqrt(double((*effects.light_map)(int(j), i))) : 1;
      phasors(int(j), i) = std::complex<float>(amplitude * cis_cycles(stretch * phase / (2 * pi)));
    }
  });
  return phasors;
}

std::vector<StuckPixel> stuck_pixels(const Slm& slm) {
  const SlmEffects& effects = slm.effects;
  const int nx = slm.grid.nx;
  std::vector<std::vector<StuckPixel>> rows(size_t(slm.grid.ny));
  if (effects.dead_fraction > 0)
    parallel_for(0, slm.grid.ny, [&](int64_t j) {
      for (int i = 0; i < nx; ++i) {
        CounterRandom random(uint64_t(effects.dead_seed), 0, uint64_t(j * nx + i));
        if (random.uniform() < effects.dead_fraction)
          rows[size_t(j)].push_back({j * nx + i, int(random.uniform() * slm.levels)});
      }
    });
  std::map<int64_t, int> level_of;
  for (const auto& row : rows)
    for (const StuckPixel& pixel : row) level_of[pixel.pixel] = pixel.level;
  for (const DeadPixel& pixel : effects.dead_pixels) level_of[int64_t(pixel.row) * nx + pixel.column] = pixel.level;
  std::vector<StuckPixel> all;
  all.reserve(level_of.size());
  for (const auto& [pixel, level] : level_of) all.push_back({pixel, level});
  return all;
}

}  // namespace holotrace
