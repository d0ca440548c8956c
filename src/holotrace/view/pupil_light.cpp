#include "holotrace/view/pupil_light.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/order_stop.h"
#include "holotrace/wave/propagate/propagate.h"

namespace holotrace {
namespace {

// Samples from low to high along one axis, on the raster of the present samples.
struct Samples {
  int count = 0;
  double centre = 0;
};

Samples samples_between(double low, double high, double pitch, int present) {
  const double first = -(present - 1) / 2.0 * pitch;
  const double begin = std::floor((low - first) / pitch), end = std::ceil((high - first) / pitch);
  return {int(end - begin) + 1, first + (begin + end) / 2 * pitch};
}

// Keeps only the light inside a round pupil.
void cut_by_pupil(Field& field, const CameraParams& camera) {
  int64_t open = 0;
  const double radius = camera.pupil / 2;
  for (int j = 0; j < field.grid.ny; ++j)
    for (int i = 0; i < field.grid.nx; ++i) {
      const bool is_open = std::hypot(field.grid.x(i) - camera.eye.x, field.grid.y(j) - camera.eye.y) <= radius;
      open += is_open;
      if (!is_open) field.samples(j, i) = 0;
    }
  const bool is_beside = std::abs(camera.eye.x - field.grid.centre_x) > field.grid.width() / 2 + radius ||
                         std::abs(camera.eye.y - field.grid.centre_y) > field.grid.height() / 2 + radius;
  require(open > 0 || !is_beside,
          "expected a pupil within the panel's window of {} × {}, got one of {} at {}, {}; move the eye",
          format_length(field.grid.width()), format_length(field.grid.height()), format_length(camera.pupil),
          format_length(camera.eye.x), format_length(camera.eye.y));
  require(open > 0,
          "expected a pupil that holds a sample of the field, got one of {} among samples {} apart; take one of {} or "
          "more",
          format_length(camera.pupil), format_length(field.grid.pitch),
          format_length(std::sqrt(2.0) * field.grid.pitch));
}

}  // namespace

std::optional<Grid> pupil_window(const Grid& shown, double wavelength, const CameraParams& camera) {
  if (camera.eye.z == 0) return shown;
  const double radius = camera.pupil / 2, spread = box_radius(camera.eye.z, wavelength, shown.pitch);
  const double right = shown.width() / 2 + spread, up = shown.height() / 2 + spread;
  if (std::abs(camera.eye.x) - radius >= right || std::abs(camera.eye.y) - radius >= up) return std::nullopt;
  const auto along = [&](double place, double reach, double side, int present) {
    const double most = reach + side / 2;
    return samples_between(std::max(place - radius, -most), std::min(place + radius, most), shown.pitch, present);
  };
  const Samples x = along(camera.eye.x, right, shown.width(), shown.nx);
  const Samples y = along(camera.eye.y, up, shown.height(), shown.ny);
  return Grid{x.count, y.count, shown.pitch, x.centre, y.centre};
}

PropagateParams to_window(const Grid& window, const PropagateParams& propagation) {
  PropagateParams params;
  params.method = propagation.method;
  params.device = propagation.device;
  params.columns = window.nx;
  params.rows = window.ny;
  params.centre_x = window.centre_x;
  params.centre_y = window.centre_y;
  return params;
}

int margin_of(const std::optional<SpectralFilter>& stop, const Grid& shown, const PropagateParams& window) {
  return stop && !window.is_periodic ? order_stop_margin(*stop, shown) : 0;
}

PropagateParams with_its_size(PropagateParams sensor, const Grid& shown) {
  const Grid window = propagation_output(shown, sensor);
  sensor.columns = window.nx;
  sensor.rows = window.ny;
  sensor.pitch = window.pitch;
  return sensor;
}

// The viewing zone, in which at least half of order 0 is seen: near the panel its own width, farther off the cone of
// its middle. (The eyebox that `limits` tells is smaller: there, light arrives from every pixel.) A stop narrows the
// cone and passes no other order.
void warn_outside_eyebox(const Field& shown, const Slm& slm, const CameraParams& camera, const Observer& observer) {
  const double z = camera.eye.z, pitch = slm.grid.pitch;
  const auto cone = [&](double half_band) {
    return box_radius(z, shown.wavelength, std::max(pitch, 1 / (2 * half_band)));
  };
  const double open = 1 / pitch;
  const double right = std::max(slm.grid.width() / 2, cone(shown.filter ? shown.filter->half_u : open));
  const double up = std::max(slm.grid.height() / 2, cone(shown.filter ? shown.filter->half_v : open));
  if (z == 0 || (std::abs(camera.eye.x) <= right && std::abs(camera.eye.y) <= up)) return;
  const char* others = shown.filter               ? "and the stop lets no other order through"
                       : shown.grid.pitch < pitch ? "and light of higher orders"
                                                  : "and higher orders need subpixels of 3 or more";
  observer.warn(
      fmt::format("the eye at {}, {} is outside the eyebox ({} × {} at {} from the panel): less than half of order 0 "
                  "reaches it, {}; move the eye to |x| ≤ {}, |y| ≤ {}",
                  format_length(camera.eye.x), format_length(camera.eye.y), format_length(2 * right),
                  format_length(2 * up), format_length(z), others, format_length(right), format_length(up)));
}

std::optional<Field> light_in_pupil(const Field& shown, const Slm& slm, const PropagateParams& propagation,
                                    const CameraParams& camera, const Observer& observer) {
  check_eye(camera);
  if (camera.pupil == 0) {
    if (!shown.filter) return std::nullopt;
    return apply_order_stop(shown, *shown.filter, margin_of(shown.filter, shown.grid, propagation), observer);
  }
  warn_outside_eyebox(shown, slm, camera, observer);
  const std::optional<Grid> window = pupil_window(shown.grid, shown.wavelength, camera);
  if (!window) return Field();
  const PropagateParams to_pupil = to_window(*window, propagation);
  Field in_pupil =
      shown.filter
          ? propagate(apply_order_stop(shown, *shown.filter, margin_of(shown.filter, shown.grid, to_pupil), observer),
                      camera.eye.z, with_its_size(to_pupil, shown.grid), observer)
          : propagate(shown, camera.eye.z, to_pupil, observer);
  cut_by_pupil(in_pupil, camera);
  return in_pupil;
}

}  // namespace holotrace
