#include "holotrace/wave/triangles/sum_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/field.h"
#include "holotrace/data/grid.h"
#include "holotrace/wave/shared/sum_by_kind.h"
#include "holotrace/wave/triangles/triangle_part.h"

namespace holotrace {
namespace {

/// How parts of triangles are summed, and the relative L2 error that is expected: the root of the energy of all errors
/// over the energy of the parts.
struct TriangleChoice {
  TileShape tile{};
  double faint = 0;   ///< see sum_triangle_tile [√(W/m²)]
  double error = 0;   ///< expected relative L2 error
  double energy = 0;  ///< energy that the parts bring to the panel, with random phases, over the pixel's area [W/m²]
  bool meets_tolerance = false;
};

// From fast to accurate; 32 columns suit every vector width.
constexpr std::array<TileShape, 6> shapes{{{64, 64}, {64, 32}, {32, 32}, {32, 16}, {32, 8}, {32, 4}}};

// Rounding error from single precision in the factors, the moments and the sum.
constexpr double float_rounding = 1e-5;

// A place at which a part's light is compared; `weight` times a value there is its share of a sum over all pixels.
struct Draw {
  const TrianglePart* part;
  int column, row;
  double weight;
  std::complex<double> envelope;  // reference: envelope of the part cut finely
};

// The pixels that receive most of a part's light: within its box, half of the way to its transform's zeros.
PixelBox lobe_of(const TrianglePart& part, const Grid& grid, double wavelength) {
  double most = 0;
  for (size_t j = 0; j < 3; ++j) most = std::max(most, length(part.offsets[j] - part.offsets[(j + 1) % 3]));
  // The slope of the triangle's own phase gives the direction of its light: along = e·offset.
  const Vec3 a = part.offsets[1] - part.offsets[0], b = part.offsets[2] - part.offsets[0];
  const double along_a = part.along[1] - part.along[0] - a.z, along_b = part.along[2] - part.along[0] - b.z;
  const double turn = a.x * b.y - a.y * b.x, small = 1e-3 * most * most;
  const double sx = std::abs(turn) > small ? (along_a * b.y - along_b * a.y) / turn : 0;
  const double sy = std::abs(turn) > small ? (along_b * a.x - along_a * b.x) / turn : 0;
  const double column = (part.centroid.x + sx * part.depth - grid.x(0)) / grid.pitch;
  const double row = (grid.y(0) - part.centroid.y - sy * part.depth) / grid.pitch;
  const double reach = wavelength * part.depth / most / grid.pitch + 1;
  const auto clamp = [](double v, int low, int high) { return int(std::clamp(v, double(low), double(high))); };
  const PixelBox& box = part.box;
  const PixelBox lobe{clamp(column - reach, box.x0, box.x1), clamp(column + reach, box.x0, box.x1),
                      clamp(row - reach, box.y0, box.y1), clamp(row + reach, box.y0, box.y1)};
  return lobe.is_empty() ? box : lobe;
}

std::vector<Draw> draw_places(const std::vector<TrianglePart>& parts, const Grid& grid, double wavelength) {
  constexpr int draws = 2048;
  std::vector<double> sums;  // running sums of power: a part is drawn in proportion to its power
  double sum = 0;
  const auto power_of = [](const TrianglePart& part) {
    double squares = 0;
    for (const double w : part.weights) squares += w * w;
    const double area = length(cross(part.offsets[1] - part.offsets[0], part.offsets[2] - part.offsets[0]));
    return squares / std::max(area, std::numeric_limits<double>::min());
  };
  sums.reserve(parts.size());
  for (const TrianglePart& part : parts) sums.push_back(sum += power_of(part));
  CounterRandom random(0, 0, 0);
  std::vector<Draw> places;
  if (!(sum > 0)) return places;
  for (int s = 0; s < draws; ++s) {
    const double u = (s / 2 + random.uniform()) / (draws / 2) * sum;
    const size_t index =
        std::min(size_t(std::upper_bound(sums.begin(), sums.end(), u) - sums.begin()), parts.size() - 1);
    const TrianglePart& part = parts[index];
    const PixelBox lobe = lobe_of(part, grid, wavelength), &from = s % 2 == 0 ? part.box : lobe;
    const int column = from.x0 + int(random.uniform() * (from.x1 - from.x0));
    const int row = from.y0 + int(random.uniform() * (from.y1 - from.y0));
    const bool in_lobe = column >= lobe.x0 && column < lobe.x1 && row >= lobe.y0 && row < lobe.y1;
    const double density = draws / 2 * (power_of(part) / sum) *
                           (1 / double(part.box.pixels()) + (in_lobe ? 1 / double(lobe.pixels()) : 0));
    places.push_back(
        {&part, column, row, 1 / density, fine_envelope_at(part, grid.x(column), grid.y(row), wavelength, 4)});
  }
  return places;
}

// Errors of one tile shape at one place: energy of the error, and energy of each row's coefficients.
struct Outcome {
  double error;
  std::array<double, envelope_nodes> rows;
};

Outcome outcome_of(const Draw& draw, const Grid& grid, double wavelength, TileShape tile) {
  const TrianglePart& part = *draw.part;
  const double xc = grid.x(draw.column - draw.column % tile.columns + (tile.columns - 1) / 2.0);
  const double yc = grid.y(draw.row - draw.row % tile.rows + (tile.rows - 1) / 2.0);
  const double half_x = tile.columns * grid.pitch / 2, half_y = tile.rows * grid.pitch / 2;
  const PartInTile p = part_in_tile(part, xc, yc, half_x, half_y, wavelength);
  if (p.gap_change > most_phase_change) return {std::numeric_limits<double>::infinity(), {}};
  EnvelopeCoefficients c;
  expand_envelope(p, half_x, half_y, c);
  const double u = (grid.x(draw.column) - xc) / half_x, v = (grid.y(draw.row) - yc) / half_y;
  const double tu[] = {1, u, 2 * u * u - 1, (4 * u * u - 3) * u}, tv[] = {1, v, 2 * v * v - 1, (4 * v * v - 3) * v};
  std::complex<double> envelope = 0;
  const double x0 = xc - part.centroid.x, y0 = yc - part.centroid.y, d2 = part.depth * part.depth;
  const double x = grid.x(draw.column) - part.centroid.x, y = grid.y(draw.row) - part.centroid.y;
  const double r = std::sqrt(x * x + y * y + d2), r0 = std::sqrt(x0 * x0 + y0 * y0 + d2);
  Outcome outcome{};
  for (int l = 0; l < envelope_nodes; ++l)
    for (int k = 0; k < envelope_nodes; ++k) {
      envelope += c[l][k] * tu[k] * tv[l];
      outcome.rows[size_t(l)] += std::norm(c[l][k]) / (r0 * r0);
    }
  const double along_column = std::sqrt(x * x + y0 * y0 + d2), along_row = std::sqrt(x0 * x0 + y * y + d2);
  const double phase = 2 * pi / wavelength * ((r - along_column) - (along_row - r0));
  const std::complex<double> split = std::polar(r * r0 / (along_column * along_row), -phase);
  outcome.error = std::norm(split * envelope - draw.envelope) / (r * r);
  return outcome;
}

/// Chooses the largest tile whose measured error, with a margin of 25 %, keeps the tolerance, and the threshold below
/// which dropped terms add at most half the tolerance. If no tile keeps it, the most accurate one.
///
/// The error is measured at 2048 places drawn from a fixed seed, half evenly over the parts' boxes and half over their
/// main lobes. There the polynomial and the split wave are compared with the envelope of the part cut four times.
///
/// @param coherence  energy of the field over the sum of its parts' energies; 1 if it is not known to be smaller
TriangleChoice choose_triangle_tile(const std::vector<TrianglePart>& parts, const Grid& grid, double wavelength,
                                    double tolerance, double coherence = 1) {
  const std::vector<Draw> draws = draw_places(parts, grid, wavelength);
  TriangleChoice choice{shapes.back(), 0, 0, 0, true};
  for (const Draw& d : draws) {
    const double x = grid.x(d.column) - d.part->centroid.x, y = grid.y(d.row) - d.part->centroid.y;
    choice.energy += d.weight * std::norm(d.envelope) / (x * x + y * y + d.part->depth * d.part->depth);
  }
  if (!(choice.energy > 0)) return choice;
  const double tangent = acceptance_tangent(wavelength, grid.pitch);
  double widest = 0;  // largest change of phase between corners [rad/m]
  for (const TrianglePart& part : parts)
    for (size_t j = 0; j < 3; ++j)
      widest = std::max(widest, 2 * pi / wavelength / part.depth *
                                    length_across(part.offsets[j] - part.offsets[(j + 1) % 3], tangent));
  for (const TileShape tile : shapes) {
    if (widest * std::hypot(tile.columns, tile.rows) * grid.pitch / 2 > most_phase_change) continue;
    double error = 0;
    std::vector<std::pair<double, double>> rows;  // energy of a row's coefficients, weight of its place
    for (const Draw& d : draws) {
      const Outcome outcome = outcome_of(d, grid, wavelength, tile);
      error += d.weight * outcome.error;
      for (const double squares : outcome.rows) rows.emplace_back(squares, d.weight);
    }
    std::sort(rows.begin(), rows.end());
    const double allowed = tolerance * tolerance * coherence * choice.energy / 4 / 1.5625;
    double dropped = 0, faint = 0;
    for (const auto& [squares, weight] : rows) {
      if (dropped + squares * weight > allowed) break;
      dropped += squares * weight;
      faint = squares;
    }
    choice.tile = tile;
    choice.faint = std::sqrt(faint);
    choice.error = (std::sqrt((error + dropped) / choice.energy) + float_rounding) / std::sqrt(coherence);
    choice.meets_tolerance = 1.25 * choice.error <= tolerance;
    if (choice.meets_tolerance) return choice;
  }
  choice.meets_tolerance = false;
  if (choice.error == 0) choice.error = 1;  // no tile can represent the phases of parts this large
  return choice;
}

/// The relative L2 error of a sum of parts, measured against their exact light at pixels of the field: half of them drawn
/// by its light, half evenly. None for so many parts that fewer than 64 pixels could be compared: the errors of many parts
/// average out, so that the expected error is met.
///
/// @param field  the sum
/// Cost: 100,000 parts at a pixel, some 5 µs each.
std::optional<double> measured_triangle_error(const std::vector<TrianglePart>& parts, const Field& field) {
  constexpr size_t work = 100000, least = 64, most = 1024;
  const size_t draws = std::min(most, work / std::max<size_t>(parts.size(), 1));
  if (draws < least) return std::nullopt;
  const Grid& grid = field.grid;
  std::vector<double> sums;  // running sums of the light
  sums.reserve(field.samples.size());
  double sum = 0;
  for (const std::complex<float>& u : field.samples.values) sums.push_back(sum += std::norm(std::complex<double>(u)));
  if (!(sum > 0)) return std::nullopt;
  std::vector<double> errors(draws);
  parallel_for(0, int64_t(draws), [&](int64_t s) {
    CounterRandom random(1, 0, uint64_t(s));
    const double place = (double(s / 2) + random.uniform()) / (double(draws + 1) / 2);
    const size_t by_light = size_t(std::upper_bound(sums.begin(), sums.end(), place * sum) - sums.begin()),
                 evenly = size_t(place * double(sums.size()));
    const size_t pixel = std::min(s % 2 == 0 ? by_light : evenly, sums.size() - 1);
    const int j = int(pixel / size_t(grid.nx)), i = int(pixel % size_t(grid.nx));
    std::complex<double> exact = 0;
    for (const TrianglePart& part : parts)
      if (i >= part.box.x0 && i < part.box.x1 && j >= part.box.y0 && j < part.box.y1)
        exact += fine_part_at(part, grid.x(i), grid.y(double(j)), field.wavelength);
    const std::complex<double> found(field.samples.values[pixel]);
    const double density = (std::norm(found) / sum + 1 / double(sums.size())) / 2;
    errors[size_t(s)] = std::norm(found - exact) / density;
  });
  double total = 0;
  for (const double error : errors) total += error;
  return std::sqrt(total / double(draws) / sum);
}

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
