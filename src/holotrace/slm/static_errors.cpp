#include "holotrace/slm/static_errors.h"

#include <cmath>
#include <cstdlib>

#include "holotrace/base/cycles.h"
#include "holotrace/base/threads.h"

namespace holotrace {

double zernike(int n, int m, double rho, double theta) {
  const int order = std::abs(m);
  double radial = 0;
  for (int s = 0; s <= (n - order) / 2; ++s)
    radial += (s % 2 ? -1 : 1) * std::tgamma(n - s + 1) /
              (std::tgamma(s + 1) * std::tgamma((n + order) / 2 - s + 1) * std::tgamma((n - order) / 2 - s + 1)) *
              std::pow(rho, n - 2 * s);
  const double norm = std::sqrt((n + 1) * (order == 0 ? 1.0 : 2.0));
  return norm * radial * (m < 0 ? std::sin(order * theta) : std::cos(order * theta));
}

Array2D<std::complex<float>> static_phasors(const Slm& slm, double stretch) {
  const SlmEffects& effects = slm.effects;
  if (effects.aberration.empty() && !effects.phase_map) return {};
  const Grid grid{slm.grid.nx, slm.grid.ny, slm.grid.pitch};
  const double radius = std::hypot(grid.width(), grid.height()) / 2;
  Array2D<std::complex<float>> phasors(grid.ny, grid.nx);
  parallel_for(0, grid.ny, [&](int64_t j) {
    for (int i = 0; i < grid.nx; ++i) {
      const double x = grid.x(i), y = grid.y(double(j));
      double phase = effects.phase_map ? double((*effects.phase_map)(int(j), i)) : 0;
      for (const ZernikeTerm& term : effects.aberration)
        phase += term.rms * zernike(term.n, term.m, std::hypot(x, y) / radius, std::atan2(y, x));
      phasors(int(j), i) = std::complex<float>(cis_cycles(stretch * phase / (2 * pi)));
    }
  });
  return phasors;
}

}  // namespace holotrace
