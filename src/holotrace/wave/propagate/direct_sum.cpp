#include "holotrace/wave/propagate/direct_sum.h"

#include "holotrace/base/threads.h"
#include "holotrace/wave/propagate/propagation_kernel.h"

namespace holotrace {

std::vector<std::complex<double>> sum_rayleigh_sommerfeld(const FieldDouble& field, const std::vector<Vec3>& points) {
  std::vector<std::complex<double>> light(points.size());
  const Grid& grid = field.grid;
  parallel_for(0, int64_t(points.size()), [&](int64_t n) {
    const Vec3 p = points[size_t(n)];
    const double start = cycle_fraction(std::abs(p.z), field.wavelength);
    std::complex<double> sum = 0;
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) {
        const double dx = p.x - grid.x(i), dy = p.y - grid.y(j);
        sum += field.samples(j, i) * rayleigh_sommerfeld_kernel(dx * dx + dy * dy, field.wavelength, p.z, start);
      }
    light[size_t(n)] = sum * grid.pitch * grid.pitch;
  });
  return light;
}

}  // namespace holotrace
