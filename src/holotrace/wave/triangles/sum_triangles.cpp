#include "holotrace/wave/triangles/sum_triangles.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/wave/shared/sum_by_kind.h"
#include "holotrace/wave/triangles/triangle_error.h"

namespace holotrace {
namespace {

void sum_parts(const std::vector<TrianglePart>& parts, const TriangleChoice& choice, Field& field,
               const Observer& observer) {
  const Grid& grid = field.grid;
  const TileShape tile = choice.tile;
  const int across = (grid.nx + tile.columns - 1) / tile.columns, down = (grid.ny + tile.rows - 1) / tile.rows;
  parallel_for(
      0, int64_t(across) * down,
      [&](int64_t t) {
        const int x0 = int(t % across) * tile.columns, y0 = int(t / across) * tile.rows;
        const PixelBox box{x0, std::min(x0 + tile.columns, grid.nx), y0, std::min(y0 + tile.rows, grid.ny)};
        sum_triangle_tile(parts, {grid, field.wavelength}, tile, box, choice.faint, field.samples);
      },
      observer);
}

// Cuts the triangles into parts and chooses their tile. The parts' bulge suits the tolerance, and tiles of 32 × 16
// pixels can represent their phases. If no tile meets the tolerance, the triangles are cut finer.
TriangleChoice prepare(const Triangles& triangles, const Grid& grid, double tolerance, double coherence,
                       std::vector<TrianglePart>& parts) {
  // A bulge of β causes an error of β²/13 where it is largest; sides of all sizes cause about a third of that.
  const double bulge = std::min(0.5, std::sqrt(13 * tolerance * std::sqrt(coherence)));
  const double slope = most_phase_change / (std::hypot(32, 16) / 2 * grid.pitch);
  TriangleChoice choice;
  for (const double finer : {0.6, 1.0, 2.0, 4.0, 8.0, 16.0}) {
    parts = cut_triangles(triangles, grid, {bulge / finer, slope / std::sqrt(std::max(1.0, finer))});
    choice = choose_triangle_tile(parts, grid, triangles.wavelength, tolerance, coherence);
    if (choice.meets_tolerance) break;
  }
  return choice;
}

double energy_of(const Field& field) {
  double sum = 0;
  for (const auto& u : field.samples.values) sum += std::norm(std::complex<double>(u));
  return sum;
}

// Warns of triangles that light no pixel, not even with a part of their area.
void warn_of_missed(const Triangles& triangles, const Grid& grid, const Observer& observer) {
  if (!observer.on_warning) return;
  const double tangent = acceptance_tangent(triangles.acceptance_wavelength(), grid.pitch);
  size_t missed = 0;
  for (const Triangle& t : triangles.triangles) {
    double left = HUGE_VAL, right = -HUGE_VAL, low = HUGE_VAL, high = -HUGE_VAL;
    for (const Vec3 p : t.corners) {
      const double reach = std::abs(p.z) * tangent;
      left = std::min(left, p.x - reach);
      right = std::max(right, p.x + reach);
      low = std::min(low, p.y - reach);
      high = std::max(high, p.y + reach);
    }
    missed += left > grid.x(grid.nx - 1) || right < grid.x(0) || low > grid.y(0) || high < grid.y(grid.ny - 1);
  }
  if (missed > 0)
    observer.warn(
        fmt::format("{} of {} triangles light no pixel: they are outside the panel's diffraction cone (half angle {}); "
                    "move them nearer to the axis or farther from the panel",
                    missed, triangles.triangles.size(),
                    format_angle(std::asin(acceptance_sine(triangles.acceptance_wavelength(), grid.pitch)))));
}

Field sum_behind(const Triangles& triangles, const Grid& grid, double tolerance, const Observer& observer) {
  Field field(grid, triangles.wavelength);
  observer.fact("triangles", triangles.triangles.size());
  observer.fact("method", std::string("triangles"));

  // If the triangles partly cancel, errors weigh more: the next round uses the coherence that this one found. Where the
  // errors of few parts add up to more than was expected, it aims at less.
  constexpr double margin = 1.25;
  double coherence = 1, expected = 0, aim = tolerance;
  std::vector<TrianglePart> parts;
  TriangleChoice choice;
  for (int round = 0; round < 5; ++round) {
    choice = prepare(triangles, grid, aim, coherence, parts);
    require(choice.meets_tolerance,
            "expected a tolerance that triangles can meet, {:.1e} or more for these, got {:.1e}; use a larger one",
            margin * choice.error * tolerance / aim, tolerance);
    sum_parts(parts, choice, field, observer);
    const double met = choice.energy > 0 ? std::min(1.0, energy_of(field) / choice.energy) : 1;
    expected = met > 0 ? choice.error * std::sqrt(coherence / met) : choice.error;
    if (met == 0) break;
    if (margin * expected > aim && round < 2) {
      coherence = met;
      continue;
    }
    if (const std::optional<double> measured = measured_triangle_error(parts, field)) expected = *measured;
    if (margin * expected <= tolerance) break;
    aim *= 0.9 * tolerance / (margin * expected);
  }
  if (expected > tolerance)
    observer.warn(fmt::format(
        "the light of triangles has an error of {:.1e}, above the tolerance of {:.1e}; use the method tiled", expected,
        tolerance));
  observer.fact("parts", parts.size());
  observer.fact("tile", fmt::format("{}x{}", choice.tile.columns, choice.tile.rows));
  observer.fact("expected_error", expected);
  return field;
}

}  // namespace

Field sum_triangles(const Triangles& triangles, const Grid& grid, double tolerance, const Observer& observer) {
  check_grid(grid);
  check_triangles(triangles);
  check_field_fits(grid, sizeof(std::complex<float>));
  require(!triangles.triangles.empty(), "expected at least one triangle, got none; is the scene lit and in view?");
  require(tolerance > 0 && tolerance < 1, "expected a tolerance in (0, 1), got {}", tolerance);
  warn_of_missed(triangles, grid, observer);
  return sum_by_kind(triangles, observer,
                     [&](const Triangles& side, const Observer& o) { return sum_behind(side, grid, tolerance, o); });
}

}  // namespace holotrace
