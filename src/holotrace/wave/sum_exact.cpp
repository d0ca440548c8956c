#include "holotrace/wave/sum_exact.h"

#include <atomic>

#include "holotrace/base/threads.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"
#include "holotrace/wave/shared/sum_by_kind.h"

namespace holotrace {

namespace {

FieldDouble sum_kind(const Sources& sources, const Grid& grid, const Observer& observer) {
  FieldDouble field(grid, sources.wavelength);
  const int parts = panel_parts(sources);
  for (int part = 0; part < parts; ++part) {
    const std::vector<PreparedWave> waves = prepare_waves(sources, grid, part);
    const PixelBox bounds = panel_part(sources, grid, part);
    const Observer of_part = part_of(observer, part, parts);
    constexpr int64_t often = 1'000'000;  // waves·pixels between reports: some tens of milliseconds
    std::atomic<double> fraction{0};
    Observer of_rows;
    of_rows.on_progress = [&](double now) {
      fraction = now;
      of_part.progress(now);
    };
    parallel_for(
        bounds.y0, bounds.y1,
        [&](int64_t j) {
          std::complex<double>* row = field.samples.row(int(j));
          const double y = grid.y(double(j));
          int64_t done = 0;
          for (const PreparedWave& wave : waves) {
            if (j < wave.box.y0 || j >= wave.box.y1) continue;
            const auto [from, to] = lit_columns(wave, grid, int(j));
            for (int i = from; i < to; ++i) row[i] += wave_at(wave, grid.x(i), y, sources.wavelength);
            done += wave.box.x1 - wave.box.x0;
            if (done < often) continue;
            done = 0;
            of_part.progress(fraction);  // a row of many waves takes long, and a caller may want to stop
          }
        },
        of_rows);
  }
  return field;
}

}  // namespace

FieldDouble sum_exact(const Sources& sources, const Grid& grid, const Observer& observer) {
  check_grid(grid);
  check_sources(sources);
  check_field_fits(grid, sizeof(std::complex<double>));
  return sum_by_kind(sources, observer,
                     [&](const Sources& kind, const Observer& o) { return sum_kind(kind, grid, o); });
}

}  // namespace holotrace
