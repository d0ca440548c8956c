#pragma once

#include <cstdint>

namespace holotrace {

/// A panel or a sensor: nx × ny square pixels of side `pitch` [m], centred on the z axis unless told otherwise.
///
///     x(i) = centre_x + (i − (nx−1)/2)·pitch,   y(j) = centre_y + ((ny−1)/2 − j)·pitch
///
/// x points right, y up, row 0 is the top row.
struct Grid {
  int nx = 0, ny = 0;
  double pitch = 0;
  double centre_x = 0, centre_y = 0;  ///< centre of the grid [m]

  double x(double column) const { return centre_x + (column - (nx - 1) / 2.0) * pitch; }
  double y(double row) const { return centre_y + ((ny - 1) / 2.0 - row) * pitch; }
  double width() const { return nx * pitch; }
  double height() const { return ny * pitch; }
  int64_t pixels() const { return int64_t(nx) * ny; }
  bool operator==(const Grid&) const = default;
};

constexpr double largest_pitch = 0.1;        ///< [m]; larger ones are numbers without their unit
constexpr double longest_wavelength = 1e-3;  ///< [m]; far infrared

/// @throws Error unless the grid has pixels and a pitch above 0 m, up to largest_pitch.
void check_grid(const Grid& grid);

/// @throws Error, stating the memory needed, unless a field with that many bytes per sample fits in this machine.
void check_field_fits(const Grid& grid, double bytes_per_sample);

/// @throws Error unless the wavelength [m] is above 0 m, up to longest_wavelength.
void check_wavelength(double wavelength);

/// The same for light on pixels, also unless it is at most 50 times their pitch: no panel and no sampling is that fine.
void check_wavelength(double wavelength, const Grid& grid);

}  // namespace holotrace
