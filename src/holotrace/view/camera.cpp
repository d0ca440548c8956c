#include "holotrace/view/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/view/expose.h"
#include "holotrace/view/select_order.h"
#include "holotrace/wave/propagate.h"

namespace holotrace {
namespace {

// Samples of the sensor's window along one axis: the present ones and an even number more or less.
int window_samples(double size, double pitch, int present) {
  require(std::isfinite(size) && size >= 0, "expected a sensor side of 0 m (the panel's) or more, got {} m", size);
  if (size == 0) return present;
  const double wanted = present + 2 * std::round((size / pitch - present) / 2);
  require(wanted >= 1, "expected a sensor of a sample of {} or more, got a side of {}", format_length(pitch),
          format_length(size));
  require(wanted < 1e9, "expected a sensor of less than 1e9 samples a side, got a side of {} in samples of {}",
          format_length(size), format_length(pitch));
  return int(wanted);
}

// Pixels of a sensor along one axis, whole ones.
int sensor_pixels(double size, double pixel) {
  require(std::isfinite(size) && size >= 0, "expected a sensor side of 0 m (the panel's) or more, got {} m", size);
  const double wanted = std::round(size / pixel);
  require(wanted >= 1, "expected a sensor of a pixel of {} or more, got a side of {}", format_length(pixel),
          format_length(size));
  require(wanted < 1e9, "expected a sensor of less than 1e9 pixels a side, got a side of {} in pixels of {}",
          format_length(size), format_length(pixel));
  return int(wanted);
}

// Light of a point of the sensor comes from no farther apart than the aperture's side, so its field has a band of
// side/λz, and no more than the 1/pitch of what is shown; the irradiance has twice that, which its samples hold.
int samples_per_pixel(double pixel, double aperture, double pitch, double wavelength, double distance) {
  const double enough = std::max(pitch, wavelength * std::abs(distance) / aperture);
  return std::max(1, int(std::ceil(2 * pixel / enough * (1 - 1e-9))));
}

// What the sensor asks of the propagation to it, and of the exposure.
struct Sensor {
  PropagateParams window;
  CameraParams exposure;
};

Sensor sensor_of(const Grid& shown, const Slm& slm, double wavelength, double distance,
                 const PropagateParams& propagation, const CameraParams& camera) {
  Sensor sensor{propagation, camera};
  const bool has_window =
      camera.width != 0 || camera.height != 0 || camera.pixel != 0 || camera.centre_x != 0 || camera.centre_y != 0;
  if (camera.pixel == 0 && camera.binning == 0)
    sensor.exposure.binning = std::max(1, int(std::lround(slm.grid.pitch / shown.pitch)));
  if (!has_window) return sensor;
  require(propagation.columns == 0 && propagation.rows == 0 && propagation.pitch == 0 && propagation.centre_x == 0 &&
              propagation.centre_y == 0,
          "expected the sensor's window once, got it by the camera's width, height, centre and pixel and by the "
          "propagation's columns, rows, centre and pitch; leave one of them out");
  sensor.window.centre_x = camera.centre_x;
  sensor.window.centre_y = camera.centre_y;
  if (camera.pixel == 0) {
    sensor.window.columns = window_samples(camera.width, shown.pitch, shown.nx);
    sensor.window.rows = window_samples(camera.height, shown.pitch, shown.ny);
    return sensor;
  }
  require(std::isfinite(camera.pixel) && camera.pixel > 0,
          "expected a sensor pixel of 0 m (as binning) or more, got {} m", camera.pixel);
  require(camera.binning >= 0, "expected a binning of 0 (as many as hold the light) or more, got {}", camera.binning);
  const double aperture = camera.pupil > 0 ? camera.pupil : std::max(shown.width(), shown.height());
  const double travelled = camera.pupil > 0 ? distance + camera.eye.z : distance;
  const int n = camera.binning > 0 ? camera.binning
                                   : samples_per_pixel(camera.pixel, aperture, shown.pitch, wavelength, travelled);
  sensor.exposure.binning = n;
  sensor.window.pitch = camera.pixel / n;
  sensor.window.columns = n * sensor_pixels(camera.width > 0 ? camera.width : slm.grid.width(), camera.pixel);
  sensor.window.rows = n * sensor_pixels(camera.height > 0 ? camera.height : slm.grid.height(), camera.pixel);
  return sensor;
}

// The light that a round pupil lets through.
void cut_by_pupil(Field& field, const CameraParams& camera) {
  int64_t open = 0;
  const double radius = camera.pupil / 2;
  for (int j = 0; j < field.grid.ny; ++j)
    for (int i = 0; i < field.grid.nx; ++i) {
      const bool is_open = std::hypot(field.grid.x(i) - camera.eye.x, field.grid.y(j) - camera.eye.y) <= radius;
      open += is_open;
      if (!is_open) field.samples(j, i) = 0;
    }
  require(open > 0, "expected a pupil within the panel's window of {} × {}, got one of {} at {}, {}; move the eye",
          format_length(field.grid.width()), format_length(field.grid.height()), format_length(camera.pupil),
          format_length(camera.eye.x), format_length(camera.eye.y));
}

// Between the middles of pixels; black past the outer ones. Added to one sum per channel.
void add_between(const Image& render, double row, double column, double* sums) {
  const int r = int(std::floor(row)), c = int(std::floor(column));
  if (c < 0 || r < 0 || c + 1 >= render.nx || r + 1 >= render.ny) return;
  const double fx = column - c, fy = row - r;
  for (int channel = 0; channel < render.channels; ++channel)
    sums[channel] += (1 - fy) * ((1 - fx) * render(r, c, channel) + fx * render(r, c + 1, channel)) +
                     fy * ((1 - fx) * render(r + 1, c, channel) + fx * render(r + 1, c + 1, channel));
}

}  // namespace

Image look(const Field& shown, const Slm& slm, double distance, const PropagateParams& propagation,
           const CameraParams& camera, const Observer& observer) {
  require(std::isfinite(distance) && distance >= 0, "expected a camera distance of 0 m or more, got {} m", distance);
  const Sensor sensor = sensor_of(shown.grid, slm, shown.wavelength, distance, propagation, camera);
  const Field stopped = shown.filter ? select_order(shown, *shown.filter, observer) : shown;
  const double z = shown.image == ImageSide::real_image ? distance : -distance;
  if (camera.pupil == 0) return expose(propagate(stopped, z, sensor.window, observer), sensor.exposure, observer);

  require(std::isfinite(camera.pupil) && camera.pupil > 0, "expected a pupil of 0 m (none) or more, got {} m",
          camera.pupil);
  require(is_finite(camera.eye) && camera.eye.z >= 0, "expected an eye on the panel or before it (z ≥ 0), got z = {}",
          format_length(camera.eye.z));
  PropagateParams to_pupil;
  to_pupil.method = propagation.method;
  Field in_pupil = propagate(stopped, camera.eye.z, to_pupil, observer);
  cut_by_pupil(in_pupil, camera);
  return expose(propagate(in_pupil, z - camera.eye.z, sensor.window, observer), sensor.exposure, observer);
}

double looking_bytes(const Grid& shown, const Slm& slm, double wavelength, double distance,
                     const PropagateParams& propagation, const CameraParams& camera) {
  const Sensor sensor = sensor_of(shown, slm, wavelength, distance, propagation, camera);
  // A distance that cannot be sampled is refused, with its reason, where it is propagated over.
  try {
    const double travelled = camera.pupil > 0 ? distance + camera.eye.z : distance;
    return propagation_bytes(shown, wavelength, travelled, sensor.window, sizeof(float));
  } catch (const Error&) {
    return sizeof(std::complex<float>) * double(propagation_output(shown, sensor.window).pixels());
  }
}

double axial_reach(const Slm& slm, double wavelength, double distance, const CameraParams& camera,
                   const std::optional<SpectralFilter>& filter) {
  if (distance <= 0) return 1;
  const double seen =
      camera.pupil > 0 ? camera.pupil * distance / (distance + camera.eye.z) : std::numeric_limits<double>::infinity();
  const double pitch = slm.grid.pitch, lit = std::sqrt(slm.fill_factor);
  const auto along = [&](double side, double half_band, double carrier) {
    const double sine = std::min(wavelength * std::min(half_band, 1 / (2 * pitch)), 1.0);
    const double box = sine < 1 ? distance * sine / std::sqrt((1 - sine) * (1 + sine)) : side;
    const double half = std::min(side / 2, box);
    constexpr int steps = 200;  // Simpson's rule on less than one lobe of sinc²: to 1e-9
    double sum = 0;
    for (int i = 0; i <= steps; ++i) {
      const double x = half * (2.0 * i / steps - 1), u = x / (wavelength * std::hypot(x, distance));
      const double a = pi * lit * pitch * (u + carrier), s = a == 0 ? 1 : std::sin(a) / a;
      sum += s * s * (i == 0 || i == steps ? 1 : i % 2 ? 4 : 2);
    }
    return sum * 2 * half / (3.0 * steps) / side;
  };
  const double open = 1 / pitch;
  return along(std::min(slm.grid.width(), seen), filter ? filter->half_u : open, filter ? filter->u0 : 0) *
         along(std::min(slm.grid.height(), seen), filter ? filter->half_v : open, filter ? filter->v0 : 0);
}

double common_white(const std::vector<Image>& views, double exposure) {
  double white = 0;
  for (const Image& view : views) white = std::max(white, exposure_white(view, exposure));
  return white;
}

Image project_render(const Image& render, double half_tangent, const Image& sensor, double distance) {
  require(render.channels == 1 || render.channels == 3, "expected a render of 1 or 3 channels, got {}",
          render.channels);
  Image out(sensor.ny, sensor.nx, render.channels);
  out.pitch = sensor.pitch;
  out.centre_x = sensor.centre_x;
  out.centre_y = sensor.centre_y;
  const double step = 2 * half_tangent / render.ny * distance;  // side of a render pixel on the sensor [m]
  if (step <= 0) return out;
  const double ratio = sensor.pitch / step;
  const int parts = std::clamp(int(std::ceil(ratio)), 1, 32);  // places of the render that a sensor pixel averages
  parallel_for(0, out.ny, [&](int64_t j) {
    for (int i = 0; i < out.nx; ++i) {
      double sums[3] = {0, 0, 0};
      for (int b = 0; b < parts; ++b)
        for (int a = 0; a < parts; ++a) {
          const double x = i + (a + 0.5) / parts - 0.5, y = double(j) + (b + 0.5) / parts - 0.5;
          add_between(render, (y - (out.ny - 1) / 2.0) * ratio - sensor.centre_y / step + (render.ny - 1) / 2.0,
                      (x - (out.nx - 1) / 2.0) * ratio + sensor.centre_x / step + (render.nx - 1) / 2.0, sums);
        }
      for (int channel = 0; channel < out.channels; ++channel)
        out(int(j), i, channel) = float(sums[channel] / (parts * parts));
    }
  });
  return out;
}

}  // namespace holotrace
