#include "holotrace/wave/sum_exact.h"

#include "holotrace/base/threads.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"

namespace holotrace {

FieldDouble sum_exact(const Sources& sources, const Grid& grid, const Observer& observer) {
  check_grid(grid);
  check_sources(sources);
  check_field_fits(grid, sizeof(std::complex<double>));
  FieldDouble field(grid, sources.wavelength);
  const int parts = panel_parts(sources);
  for (int part = 0; part < parts; ++part) {
    const std::vector<PreparedWave> waves = prepare_waves(sources, grid, part);
    const PixelBox bounds = panel_part(sources, grid, part);
    parallel_for(
        bounds.y0, bounds.y1,
        [&](int64_t j) {
          std::complex<double>* row = field.samples.row(int(j));
          const double y = grid.y(double(j));
          for (const PreparedWave& wave : waves)
            if (j >= wave.box.y0 && j < wave.box.y1)
              for (int i = wave.box.x0; i < wave.box.x1; ++i) row[i] += wave_at(wave, grid.x(i), y, sources.wavelength);
        },
        part_of(observer, part, parts));
  }
  return field;
}

}  // namespace holotrace
