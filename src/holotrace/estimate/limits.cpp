#include "holotrace/estimate/limits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"

namespace holotrace {
namespace {

void check_distance(double distance) {
  require(std::isfinite(distance) && distance > 0, "expected a distance above 0 m, got {}", format_length(distance));
}

}  // namespace

Limits limits(const Grid& grid, double wavelength, double distance) {
  check_grid(grid);
  check_wavelength(wavelength, grid);
  check_distance(distance);
  const double sx = grid.width(), sy = grid.height(), z = distance;
  Limits l;
  l.half_angle = std::asin(acceptance_sine(wavelength, grid.pitch));
  l.field_of_view = 2 * l.half_angle;
  l.first_order_angle = std::asin(std::fmin(wavelength / grid.pitch, 1));
  l.order_spacing = grating_order_offset(grid.pitch, wavelength, z);
  l.box_radius = box_radius(z, wavelength, grid.pitch);
  l.resolution_x = wavelength * z / sx;
  l.resolution_y = wavelength * z / sy;
  l.depth_of_focus_x = 2 * wavelength * z * z / (sx * sx);
  l.depth_of_focus_y = 2 * wavelength * z * z / (sy * sy);
  l.space_bandwidth = grid.pixels();
  l.finest_grating = 2 * grid.pitch;
  // If nothing limits the angle, boxes are infinite: every point lights the whole panel.
  const double tangent = acceptance_tangent(wavelength, grid.pitch);
  l.alias_free_distance = std::max(sx, sy) / tangent;
  l.whole_panel_distance = l.alias_free_distance / 2;
  l.whole_panel_x = l.eyebox_x = std::max(0.0, 2 * l.box_radius - sx);
  l.whole_panel_y = l.eyebox_y = std::max(0.0, 2 * l.box_radius - sy);
  l.replica_free = l.order_spacing;
  return l;
}

std::vector<DiffractionOrder> diffraction_orders(double pitch, double wavelength, double distance, int most) {
  std::vector<DiffractionOrder> orders;
  for (int n = -most; n <= most; ++n) {
    const double offset = grating_order_offset(pitch, wavelength, distance, n);
    if (std::isfinite(offset)) orders.push_back({n, std::asin(n * wavelength / pitch), offset});
  }
  return orders;
}

double grating_order_offset(double period, double wavelength, double distance, int order) {
  check_wavelength(wavelength);
  check_distance(distance);
  require(std::isfinite(period) && period > 0, "expected a grating period above 0 m, got {}", format_length(period));
  const double sine = order * wavelength / period;
  if (std::abs(sine) >= 1) return std::copysign(std::numeric_limits<double>::infinity(), sine);
  return distance * sine / std::sqrt((1 - sine) * (1 + sine));
}

double wanted_pitch(double wavelength, double half_angle) {
  check_wavelength(wavelength);
  require(half_angle > 0 && half_angle < pi / 2, "expected a half angle above 0° and below 90°, got {}",
          format_angle(half_angle));
  return wavelength / (2 * std::tan(half_angle));
}

double wanted_size(double wavelength, double distance, double resolution) {
  check_wavelength(wavelength);
  check_distance(distance);
  require(std::isfinite(resolution) && resolution > 0, "expected a resolution above 0 m, got {}",
          format_length(resolution));
  return wavelength * distance / resolution;
}

int64_t wanted_pixels(double size, double pitch) {
  require(std::isfinite(size) && size > 0, "expected a panel size above 0 m, got {}", format_length(size));
  require(std::isfinite(pitch) && pitch > 0, "expected a pixel pitch above 0 m, got {}", format_length(pitch));
  const double pixels = std::ceil(size / pitch * (1 - 1e-12));  // a size that divides evenly must not round up
  require(pixels <= 1e15, "expected a panel of 1e15 pixels or less along a side, got {:.3g}: {} at a pitch of {}",
          pixels, format_length(size), format_length(pitch));
  return int64_t(pixels);
}

double pixel_rate(double pixels, int colours, double frames_per_second) {
  require(std::isfinite(pixels) && pixels > 0, "expected 1 pixel or more, got {}", pixels);
  require(colours >= 1, "expected 1 colour or more, got {}", colours);
  require(std::isfinite(frames_per_second) && frames_per_second > 0, "expected more than 0 frames per second, got {}",
          frames_per_second);
  return pixels * colours * frames_per_second;
}

}  // namespace holotrace
