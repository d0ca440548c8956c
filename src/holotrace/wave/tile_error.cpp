#include "holotrace/wave/tile_error.h"

#include "holotrace/base/random.h"

namespace holotrace {

double separability_error(const std::vector<PreparedWave>& waves, const Grid& grid, double wavelength, TileShape tile) {
  constexpr int draws = 8192;
  CounterRandom random(0, 0, 0);
  double error = 0, energy = 0;
  for (int s = 0; s < draws; ++s) {
    const size_t j = size_t((s + random.uniform()) / draws * double(waves.size()));
    const PreparedWave& w = waves[j];
    const double along_x = random.uniform(), along_y = random.uniform();
    if (w.box.is_empty()) continue;
    const int i = w.box.x0 + int(along_x * (w.box.x1 - w.box.x0));
    const int k = w.box.y0 + int(along_y * (w.box.y1 - w.box.y0));
    // The tile's centre as sum_tiled places it: tiles start at pixel (0, 0).
    const double x0 = grid.x(i - i % tile.columns + (tile.columns - 1) / 2.0) - w.x;
    const double y0 = grid.y(k - k % tile.rows + (tile.rows - 1) / 2.0) - w.y;
    const double x = grid.x(i) - w.x, y = grid.y(k) - w.y, d2 = w.depth * w.depth;
    const double r = std::sqrt(x * x + y * y + d2), r0 = std::sqrt(x0 * x0 + y0 * y0 + d2);
    const double along_column = std::sqrt(x * x + y0 * y0 + d2), along_row = std::sqrt(x0 * x0 + y * y + d2);
    const double phase = 2 * pi / wavelength * ((r - along_column) - (along_row - r0));
    const double modulus = r * r0 / (along_column * along_row);
    const double weight = w.amplitude * w.amplitude * (d2 / (r * r)) * double(w.box.pixels());
    error += weight * std::norm(std::polar(modulus, -phase) - 1.0);
    energy += weight;
  }
  return energy > 0 ? std::sqrt(error / energy) : 0;
}

TileChoice choose_tile(const std::vector<PreparedWave>& waves, const Grid& grid, double wavelength, double tolerance) {
  TileChoice choice{};
  for (const TileShape tile : tile_shapes) {
    const double error = separability_error(waves, grid, wavelength, tile) + tiled_rounding_error;
    choice = {tile, error, 1.25 * error <= tolerance};
    if (choice.meets_tolerance) break;
  }
  return choice;
}

}  // namespace holotrace
