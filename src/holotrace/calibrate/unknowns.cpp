#include "holotrace/calibrate/unknowns.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "holotrace/base/error.h"
#include "holotrace/calibrate/patterns.h"
#include "holotrace/slm/panel/static_errors.h"

namespace holotrace {
namespace {

// Over [−1, 1].
double legendre(int degree, double x) {
  double before = 1, now = x;
  if (degree == 0) return 1;
  for (int n = 1; n < degree; ++n) {
    const double next = ((2 * n + 1) * x * now - n * before) / (n + 1);
    before = now;
    now = next;
  }
  return now;
}

}  // namespace

UnknownsBasis make_basis(const std::vector<TestPattern>& patterns, const CalibrateParams& params) {
  UnknownsBasis basis;
  const Hologram& first = patterns.front().hologram;
  basis.slm = with_effects(*first.slm, {});
  basis.wavelength = first.wavelength;
  std::set<int> levels{0};
  for (const TestPattern& pattern : patterns)
    for (const uint16_t level : pattern.hologram.level.values) levels.insert(level);
  basis.levels.assign(levels.begin(), levels.end());
  for (int n = 1; n <= params.light_order; ++n)
    for (int x = n; x >= 0; --x) basis.light.push_back({x, n - x});
  for (int n = 2; n <= params.aberration_order; ++n)
    for (int m = -n; m <= n; m += 2) basis.aberration.push_back({n, m, 0});
  basis.amplitude_order = std::min(params.amplitude_order, int(basis.levels.size()) - 2);
  return basis;
}

Unknowns first_guess(const UnknownsBasis& basis, const Slm& assumed, size_t photographs) {
  Unknowns u;
  u.light.assign(basis.light.size(), 0);
  u.aberration.assign(basis.aberration.size(), 0);
  const double zero = assumed_phase(assumed, 0, basis.wavelength);
  for (const int level : basis.levels) u.phases.push_back(assumed_phase(assumed, level, basis.wavelength) - zero);
  u.amplitude.assign(size_t(std::max(0, basis.amplitude_order)), 0);
  u.crosstalk = 0.25;  // a middling panel of liquid crystal
  u.gap = 0;
  u.exposures.assign(photographs, {});
  return u;
}

double& value_of(Unknowns& u, const Unknown& unknown) {
  const size_t k = unknown.index;
  switch (unknown.kind) {
    case UnknownKind::camera:
      return *std::array<double*, 4>{&u.camera.a, &u.camera.b, &u.camera.x, &u.camera.y}[k];
    case UnknownKind::blur:
      return u.blur;
    case UnknownKind::light:
      return u.light[k];
    case UnknownKind::aberration:
      return u.aberration[k];
    case UnknownKind::phase:
      return u.phases[k];
    case UnknownKind::amplitude:
      return u.amplitude[k];
    case UnknownKind::crosstalk:
      return u.crosstalk;
    case UnknownKind::gap:
      return reinterpret_cast<double(&)[2]>(u.gap)[k];
    case UnknownKind::exposure:
      break;
  }
  return k % 2 == 0 ? u.exposures[k / 2].gain : u.exposures[k / 2].offset;
}

double amplitude_term(const UnknownsBasis& basis, size_t k, double level) {
  const int degree = int(k) + 1;
  return legendre(degree, 2 * level / (basis.slm.levels - 1) - 1) - legendre(degree, -1);
}

double amplitude_of(const UnknownsBasis& basis, const Unknowns& unknowns, double level) {
  double log = 0;
  for (size_t k = 0; k < unknowns.amplitude.size(); ++k) log += unknowns.amplitude[k] * amplitude_term(basis, k, level);
  return std::exp(log);
}

Array2D<float> light_term_on(const Grid& grid, const LightTerm& term) {
  Array2D<float> values(grid.ny, grid.nx);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i)
      values(j, i) =
          float(legendre(term.x, (2 * i + 1.0) / grid.nx - 1) * legendre(term.y, 1 - (2 * j + 1.0) / grid.ny));
  return values;
}

Array2D<float> zernike_on(const Grid& grid, const ZernikeTerm& term) {
  Array2D<float> values(grid.ny, grid.nx);
  const double radius = std::hypot(grid.width(), grid.height()) / 2;
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      const double x = grid.x(i) - grid.centre_x, y = grid.y(j) - grid.centre_y;
      values(j, i) = float(zernike(term.n, term.m, std::hypot(x, y) / radius, std::atan2(y, x)));
    }
  return values;
}

GapFigures gap_figures(double assumed_fill, std::complex<double> gap) {
  const double strength = std::abs(gap);
  if (strength == 0) return {assumed_fill, 0, 0};
  const double fill = std::min(assumed_fill, 1 / (1 + strength));
  return {fill, std::min(1.0, strength * fill / (1 - fill)), std::arg(gap)};
}

}  // namespace holotrace
