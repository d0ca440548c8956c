#include "holotrace/wave/sum_exact.h"

#include <atomic>
#include <cmath>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
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

namespace {

// A drawn pixel, the part of the panel that it lies in, and the exact field of the waves there.
struct Drawn {
  int i, j, part;
  std::complex<double> exact = 0;
};

std::vector<Drawn> draw(const Sources& sources, const Grid& grid, int pixels, uint64_t seed) {
  CounterRandom random(seed, 0, 0);
  std::vector<Drawn> drawn;
  const int parts = panel_parts(sources);
  for (int p = 0; p < pixels; ++p) {
    const int i = std::min(int(random.uniform() * grid.nx), grid.nx - 1);
    const int j = std::min(int(random.uniform() * grid.ny), grid.ny - 1);
    int part = 0;
    for (; part + 1 < parts; ++part) {
      const PixelBox box = panel_part(sources, grid, part);
      if (i >= box.x0 && i < box.x1 && j >= box.y0 && j < box.y1) break;
    }
    drawn.push_back({i, j, part});
  }
  return drawn;
}

template <class Samples>
double error_of(const Samples& field, const Sources& sources, int pixels, uint64_t seed) {
  require(pixels >= 1, "expected at least one pixel to compare, got {}", pixels);
  require(field.wavelength == sources.wavelength,
          "expected a field of the sources' wavelength {} m, got one of {} m; compare a field with its own sources",
          sources.wavelength, field.wavelength);
  check_grid(field.grid);
  check_sources(sources);
  const Grid& grid = field.grid;
  std::vector<Drawn> drawn = draw(sources, grid, pixels, seed);
  const auto add = [&](const Sources& kind, bool is_mirrored) {
    for (int part = 0; part < panel_parts(kind); ++part) {
      const std::vector<PreparedWave> waves = prepare_waves(kind, grid, part);
      parallel_for(0, pixels, [&](int64_t p) {
        Drawn& at = drawn[size_t(p)];
        if (at.part != part) return;
        std::complex<double> sum = 0;
        for (const PreparedWave& wave : waves)
          if (at.j >= wave.box.y0 && at.j < wave.box.y1)
            if (const auto [from, to] = lit_columns(wave, grid, at.j); at.i >= from && at.i < to)
              sum += wave_at(wave, grid.x(at.i), grid.y(at.j), sources.wavelength);
        at.exact += is_mirrored ? std::conj(sum) : sum;
      });
    }
  };
  const auto [behind, mirrored, astigmatic] = kinds_of(sources);
  add(behind, false);
  add(mirrored, true);
  for (const Sources& group : astigmatic) add(group, false);
  double difference = 0, energy = 0;
  for (const Drawn& at : drawn) {
    difference += std::norm(std::complex<double>(field.samples(at.j, at.i)) - at.exact);
    energy += std::norm(at.exact);
  }
  return difference == 0 ? 0 : std::sqrt(difference / energy);
}

}  // namespace

double sampled_error(const Field& field, const Sources& sources, int pixels, uint64_t seed) {
  return error_of(field, sources, pixels, seed);
}

double sampled_error(const FieldDouble& field, const Sources& sources, int pixels, uint64_t seed) {
  return error_of(field, sources, pixels, seed);
}

}  // namespace holotrace
