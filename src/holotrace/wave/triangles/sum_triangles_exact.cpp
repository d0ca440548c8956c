#include <algorithm>
#include <cmath>

#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/wave/shared/sum_by_kind.h"
#include "holotrace/wave/triangles/sum_triangles.h"
#include "holotrace/wave/triangles/triangle_part.h"

namespace holotrace {

namespace {

FieldDouble sum_behind_exactly(const Triangles& triangles, const Grid& grid, double bulge, const Observer& observer) {
  FieldDouble field(grid, triangles.wavelength);
  const std::vector<TrianglePart> parts = cut_triangles(triangles, grid, {.bulge = bulge});
  parallel_for(
      0, grid.ny,
      [&](int64_t j) {
        std::complex<double>* row = field.samples.row(int(j));
        for (const TrianglePart& part : parts)
          if (j >= part.box.y0 && j < part.box.y1)
            for (int i = part.box.x0; i < part.box.x1; ++i)
              row[i] += part_at(part, grid.x(i), grid.y(double(j)), triangles.wavelength);
      },
      observer);
  return field;
}

// The padded window along one axis, centred on the panel.
struct Axis {
  int padded;
  double side, centre;

  // Frequencies whose light reaches the window from a place at that depth, at most the panel's: [lowest, highest].
  std::array<double, 2> band(double from, double depth, double wavelength, double pitch) const {
    const auto frequency = [&](double x) { return x / (wavelength * std::hypot(x, depth)); };
    const double edge = 1 / (2 * pitch);
    return {std::max(-edge, frequency(centre - side / 2 - from)), std::min(edge, frequency(centre + side / 2 - from))};
  }
};

Axis make_axis(int pixels, double pitch, double centre, double farthest, int padding) {
  // Light goes at most `farthest` from the centre. What leaves the window by more than the panel's width wraps around.
  const double wanted = pixels * pitch / 2 + farthest;
  const int padded = fft_good_length(int(std::ceil(std::min(wanted / pitch, double(padding) * pixels))));
  const int least = fft_good_length(2 * pixels);
  const int length = std::max(padded, least);
  return {length, length * pitch, centre};
}

FieldDouble spectrum_behind(const Triangles& triangles, const Grid& grid, int padding, const Observer& observer) {
  const double lambda = triangles.wavelength,
               tangent = acceptance_tangent(triangles.acceptance_wavelength(), grid.pitch);
  double far_x = 0, far_y = 0;
  for (const Triangle& t : triangles.triangles)
    for (const Vec3 p : t.corners) {
      far_x = std::max(far_x, std::abs(p.x - grid.centre_x) - p.z * tangent);
      far_y = std::max(far_y, std::abs(p.y - grid.centre_y) - p.z * tangent);
    }
  const Axis across = make_axis(grid.nx, grid.pitch, grid.centre_x, far_x, padding);
  const Axis down = make_axis(grid.ny, grid.pitch, grid.centre_y, far_y, padding);
  check_field_fits({across.padded, down.padded, grid.pitch}, sizeof(std::complex<double>));
  Array2D<std::complex<double>> spectrum(down.padded, across.padded);
  parallel_for(
      0, down.padded,
      [&](int64_t row) {
        const double v = -signed_frequency(int(row), down.padded) / down.side;  // rows go down
        for (const Triangle& t : triangles.triangles) {
          const Vec3 c = centroid(t), e = t.direction;
          const auto [v0, v1] = down.band(c.y, -c.z, lambda, grid.pitch);
          const auto [u0, u1] = across.band(c.x, -c.z, lambda, grid.pitch);
          if (v < v0 || v >= v1) continue;
          const double scale = 2 * area_along_direction(t) / lambda;
          const double start = t.phase / (2 * pi) - cycle_fraction(-c.z / e.z, lambda);
          for (int i = 0; i < across.padded; ++i) {
            const double u = signed_frequency(i, across.padded) / across.side;
            if (u < u0 || u >= u1) continue;
            const double squared = 1 / (lambda * lambda) - u * u - v * v;
            if (squared <= 0) continue;                                                        // evanescent
            const double w = std::sqrt(squared), slack = -(u * u + v * v) / (1 / lambda + w);  // w − 1/λ
            double phases[3];
            for (size_t k = 0; k < 3; ++k) {
              const Vec3 s = t.corners[k] - c;
              phases[k] = 2 * pi * (dot(e, s) / lambda - u * s.x - v * s.y - w * s.z);
            }
            const CornerOrder o = order_corners(phases);
            const double a[3] = {t.amplitudes[size_t(o.first)], t.amplitudes[size_t(o.middle)],
                                 t.amplitudes[size_t(o.last)]};
            const Phasor<double> none[3] = {};
            const Phasor<double> m =
                combine(triangle_moments(phases[o.first], phases[o.middle], phases[o.last]), a, none);
            // Phase of the centroid less the phase of the window's corner pixel, where the transform starts.
            const double cycles =
                start + cycle_fraction(-c.z, lambda) - slack * c.z - u * (c.x - grid.x(0)) - v * (c.y - grid.y(0));
            spectrum(int(row), i) += std::complex<double>(m.re, m.im) * cis_cycles(cycles) * (scale / w);
          }
        }
      },
      observer);
  fft_2d(spectrum.values.data(), down.padded, across.padded, FftDirection::backward);
  FieldDouble field(grid, lambda);
  const double per_frequency = 1 / (across.side * down.side);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) field.samples(j, i) = spectrum(j, i) * per_frequency;
  return field;
}

}  // namespace

FieldDouble sum_triangles_exact(const Triangles& triangles, const Grid& grid, double bulge, const Observer& observer) {
  check_grid(grid);
  check_triangles(triangles);
  check_field_fits(grid, sizeof(std::complex<double>));
  return sum_by_kind(triangles, observer, [&](const Triangles& side, const Observer& o) {
    return sum_behind_exactly(side, grid, bulge, o);
  });
}

FieldDouble sum_triangles_spectrum(const Triangles& triangles, const Grid& grid, int padding,
                                   const Observer& observer) {
  check_grid(grid);
  check_triangles(triangles);
  return sum_by_kind(triangles, observer,
                     [&](const Triangles& side, const Observer& o) { return spectrum_behind(side, grid, padding, o); });
}

}  // namespace holotrace
