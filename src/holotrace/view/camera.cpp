#include "holotrace/view/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/view/device_camera.h"
#include "holotrace/view/diffraction_orders.h"
#include "holotrace/view/expose.h"
#include "holotrace/view/pupil_light.h"
#include "holotrace/view/sensor.h"
#include "holotrace/view/source_image.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/propagate/propagator.h"
#include "holotrace/wave/shared/stage_on_device.h"

namespace holotrace {
namespace {

bool has_window(const PropagateParams& p) {
  return p.columns != 0 || p.rows != 0 || p.pitch != 0 || p.centre_x != 0 || p.centre_y != 0;
}

double plane_of(double distance, ImageSide image) { return image == ImageSide::real_image ? distance : -distance; }

// The camera without its lens, with its sensor in the plane in focus, about the panel's axis.
CameraParams in_object_plane(const CameraParams& camera, double distance, ImageSide image,
                             const PropagateParams& propagation) {
  CameraParams out = camera;
  const double m = magnification(camera, distance, image);
  for (double* size : {&out.width, &out.height, &out.centre_x, &out.centre_y, &out.pixel}) *size /= m;
  if (has_window(propagation)) return out;
  const Vec2 middle = middle_of_window(camera, distance, image);
  out.centre_x += middle.x * std::abs(distance);
  out.centre_y += middle.y * std::abs(distance);
  return out;
}

// Whether light of a window, within the angles that its samples represent, reaches another window.
bool reaches(const Grid& from, const Grid& to, double wavelength, double distance) {
  const double spread = box_radius(std::abs(distance), wavelength, from.pitch);
  return std::abs(to.centre_x - from.centre_x) < (from.width() + to.width()) / 2 + spread &&
         std::abs(to.centre_y - from.centre_y) < (from.height() + to.height()) / 2 + spread;
}

// Adds the value interpolated between pixel centres to one sum per channel; 0 beyond the outer pixels.
void add_between(const Image& render, double row, double column, double* sums) {
  if (std::abs(row - (render.ny - 1) / 2.0) > render.ny / 2.0 ||
      std::abs(column - (render.nx - 1) / 2.0) > render.nx / 2.0)
    return;
  row = std::clamp(row, 0.0, render.ny - 1.0);  // the outer half of a pixel has no neighbour
  column = std::clamp(column, 0.0, render.nx - 1.0);
  const int r = int(row), c = int(column);
  const int below = std::min(r + 1, render.ny - 1), right = std::min(c + 1, render.nx - 1);
  const double fx = column - c, fy = row - r;
  for (int channel = 0; channel < render.channels; ++channel)
    sums[channel] += (1 - fy) * ((1 - fx) * render(r, c, channel) + fx * render(r, right, channel)) +
                     fy * ((1 - fx) * render(below, c, channel) + fx * render(below, right, channel));
}

}  // namespace

void check_eye(const CameraParams& camera) { check_ranges(camera); }

Vec2 middle_of_window(const CameraParams& camera, double distance, ImageSide image) {
  const Vec3& eye = camera.eye;
  if (camera.window != ViewWindow::eye || camera.pupil == 0 || eye.z <= 0) return {0, 0};
  const double side = std::copysign(1, plane_of(distance, image));
  return {side * eye.x / eye.z, side * eye.y / eye.z};
}

double magnification(const CameraParams& camera, double distance, ImageSide image) {
  if (camera.focal_length == 0) return 1;
  const double f = camera.focal_length;
  check_range(f, range::not_negative, Quantity::length, " for \"focal_length\"");
  require(camera.pupil > 0, "expected a pupil above 0 m for a lens of {}, got 0 m; give its diameter",
          format_length(f));
  const double s = camera.eye.z - plane_of(distance, image);
  require(s > f,
          "expected a plane farther from the lens than its focal length of {}, got one at {}; move the eye "
          "back, or use a shorter focal length",
          format_length(f), format_length(s));
  return f / (s - f);
}

namespace {

// The sensor in front of that light, in the plane in focus (of the object, with a lens).
struct Focus {
  double z, magnification;
  CameraParams camera;
  Sensor sensor;
};

Focus focus_of(const FieldShape& shown, const Slm& slm, double distance, const PropagateParams& propagation,
               const CameraParams& with_lens, const Observer& observer, const SourcePart& source) {
  require(std::isfinite(distance), "expected a finite camera distance, got {}", format_length(distance));
  check_eye(with_lens);
  const double m = magnification(with_lens, distance, shown.image), z = plane_of(distance, shown.image);
  const CameraParams camera = in_object_plane(with_lens, distance, shown.image, propagation);
  return {z, m, camera, sensor_of(shown, slm, z, propagation, camera, std::abs(z) * source.reach(), observer)};
}

// Whether light of the panel that passes the pupil arrives in the plane in focus.
bool is_lit(const FieldShape& shown, const Focus& focus) {
  if (focus.camera.pupil == 0) return true;
  const std::optional<Grid> window = pupil_window(shown.grid, shown.wavelength, focus.camera);
  const Grid plane = propagation_output(shown.grid, focus.sensor.window);
  return window && reaches(*window, plane, shown.wavelength, focus.z - focus.camera.eye.z);
}

// What comes back from a device: pixels; with a blur, the irradiance at the samples instead.
struct Exposure {
  Array2D<float> irradiance{};
  Image pixels{};
};

Exposure expose(const DeviceField& at, const Sensor& sensor) {
  Device& device = *at.device;
  const Grid& grid = at.head.grid;
  Exposure exposure;
  const PixelSums sums = pixel_sums(grid.ny, grid.nx, sensor.samples, sensor.rim, sensor.is_integrated);
  const auto lock = device.lock();
  make_room(device, sizeof(float) * (double(grid.pixels()) + double(sums.rows) * (sums.across + sums.columns) +
                                     double(sums.weights.size())));
  const DeviceBuffer irradiance = irradiance_of(at);
  if (sensor.blur == 0) {
    exposure.pixels = mean_over_pixels(device, irradiance, grid.nx, sums);
  } else {
    exposure.irradiance = Array2D<float>(grid.ny, grid.nx);
    device.read(irradiance, exposure.irradiance.values.data(), irradiance.bytes());
  }
  return exposure;
}

// The same on the device that the propagation names, after the propagation to the sensor.
std::optional<Exposure> expose_on_device(const PlacedField& light, double distance, const PropagateParams& window,
                                         const Sensor& sensor, const Observer& observer) {
  const auto fastest = [&] {
    const PropagationForecast forecast(light.head().grid, light.head().wavelength, distance, window);
    const double values = sensor.blur > 0 ? double(window.columns) * window.rows : double(sensor.pixels.pixels());
    return fastest_device(light.seconds_to_processor() + forecast.on_processor(), [&](Device& device) {
      return light.seconds_to(device) + forecast.on_device(device) +
             sizeof(float) * values / device_rates(device).bytes;
    });
  };
  return on_chosen_device(window.device, observer, fastest, [&](Device& device) {
    return expose(propagate(*light.on(device, observer), distance, window, observer), sensor);
  });
}

// The pixels of a sensor, if there is light in front of it.
Image read_focused(const PlacedField* light, const FieldShape& shown, const Focus& focus, const SourcePart& source,
                   const Observer& observer) {
  const auto& [z, m, camera, sensor] = focus;
  const double distance = camera.pupil > 0 ? z - camera.eye.z : z;
  PropagateParams window = with_its_size(sensor.window, shown.grid);
  Exposure exposure;
  if (!light) {
    exposure.pixels = Image(sensor.pixels.ny, sensor.pixels.nx, 1);
  } else if (auto there = expose_on_device(*light, distance, window, sensor, observer)) {
    exposure = std::move(*there);
  } else {
    window.device = {};
    exposure.irradiance = propagate_to_irradiance(*light->on_processor(observer), distance, window, observer);
  }
  if (exposure.irradiance.size() > 0) {
    if (sensor.blur > 0)
      exposure.irradiance = convolved(exposure.irradiance, source_image(source, z, sensor.window.pitch, sensor.blur));
    exposure.pixels = mean_over_pixels(exposure.irradiance, sensor.samples, sensor.rim, sensor.is_integrated, observer);
  }
  Image image = std::move(exposure.pixels);
  image.pitch = sensor.pixels.pitch * m;
  image.centre_x = sensor.pixels.centre_x * m;
  image.centre_y = sensor.pixels.centre_y * m;
  if (m != 1)
    for (float& value : image.values) value = float(double(value) / (m * m));
  return image;
}

}  // namespace

FieldShape shape_of(const Field& field) { return {field.grid, field.wavelength, field.image, field.filter}; }

Image focus_light(const PassedLight& passed, const Slm& slm, double distance, const PropagateParams& propagation,
                  const CameraParams& camera, const Observer& observer, const SourcePart& source) {
  const auto& [light, shown] = passed;
  const Focus focus = focus_of(shown, slm, distance, propagation, camera, observer, source);
  const bool has_light = !light.is_empty() && is_lit(shown, focus);
  return read_focused(has_light ? &light : nullptr, shown, focus, source, observer);
}

Image look(const PlacedField& shown, const Slm& slm, double distance, const PropagateParams& propagation,
           const CameraParams& camera, const Observer& observer, const SourcePart& source) {
  const FieldShape shape = shape_of(shown.head());
  const Focus focus = focus_of(shape, slm, distance, propagation, camera, observer, source);
  if (!is_lit(shape, focus)) {
    warn_outside_eyebox(shown.head(), slm, focus.camera, observer);
    return read_focused(nullptr, shape, focus, source, observer);
  }
  const PlacedField passed = light_in_pupil(shown, slm, propagation, camera, observer);
  return read_focused(&passed, shape, focus, source, observer);
}

Image look(const Field& shown, const Slm& slm, double distance, const PropagateParams& propagation,
           const CameraParams& camera, const Observer& observer, const SourcePart& source) {
  return look(PlacedField::of(shown), slm, distance, propagation, camera, observer, source);
}

double looking_bytes(const FieldShape& field, const Slm& slm, double distance, const PropagateParams& propagation,
                     const CameraParams& with_lens, const SourcePart& source) {
  const double z = plane_of(distance, field.image), wavelength = field.wavelength;
  const Grid& shown = field.grid;
  const CameraParams camera = in_object_plane(with_lens, distance, field.image, propagation);
  const Sensor read = sensor_of(field, slm, z, propagation, camera, std::abs(z) * source.reach());
  const PropagateParams& window = read.window;
  const Grid sensor = propagation_output(shown, window);
  constexpr double complex_bytes = sizeof(std::complex<float>), real_bytes = sizeof(float);
  // Bytes after the propagation: the field, its irradiance, the blur, and the pixels.
  const double picture_side = 2.0 * read.blur + 1;  // of the image of the source
  const double blurring =
      read.blur > 0 ? real_bytes * picture_side * picture_side + convolved_bytes(sensor.ny, sensor.nx) : 0;
  const double reading =
      (complex_bytes + real_bytes) * double(sensor.pixels()) + blurring + real_bytes * double(read.pixels.pixels());
  // A distance that cannot be sampled is rejected later, with its reason, by the propagation itself.
  const auto bytes_over = [&](const Grid& from, double over, const PropagateParams& params) {
    try {
      return propagation_bytes(from, wavelength, over, params, sizeof(float));
    } catch (const Error&) {
      return complex_bytes * double(sensor.pixels());
    }
  };
  const int margin = margin_of(field.filter, shown, window);
  const Grid behind_stop{shown.nx + 2 * margin, shown.ny + 2 * margin, shown.pitch};
  const double stopped = complex_bytes * double(behind_stop.pixels());
  const double stopping = field.filter ? order_stop_cost(shown, *field.filter, margin).memory : 0;
  if (camera.pupil == 0)
    return std::max({stopping, reading, stopped + bytes_over(behind_stop, z, with_its_size(window, shown))});
  const std::optional<Grid> pupil = pupil_window(shown, wavelength, camera);
  if (!pupil) return reading;
  const double in_pupil = complex_bytes * double(pupil->pixels());
  return std::max({stopping, stopped + bytes_over(behind_stop, camera.eye.z, to_window(*pupil, propagation)),
                   in_pupil + bytes_over(*pupil, z - camera.eye.z, with_its_size(window, shown)), in_pupil + reading});
}

double axial_reach(const Slm& slm, const HologramLight& light, double from_panel, const CameraParams& camera) {
  if (from_panel == 0) return 1;
  // The pupil's shadow on the panel, as seen from the point behind or in front of the panel.
  const double z = std::abs(camera.eye.z - plane_of(from_panel, light.image)), distance = std::abs(from_panel);
  const double seen = camera.pupil > 0 && z > 0 ? camera.pupil * distance / z : std::numeric_limits<double>::infinity();
  const double pitch = slm.grid.pitch;
  const double lambda = light.wavelength;
  const double cone = (light.cone_wavelength > 0 ? light.cone_wavelength : lambda) / (2 * pitch);
  const auto along = [&](double side, double lit, double half_band, double carrier) {
    const double sine = std::min({lambda * half_band, cone, 1.0});
    const double box = light.losses.by_cone && sine < 1 ? distance * sine / std::sqrt((1 - sine) * (1 + sine)) : side;
    const double half = std::min(side / 2, box);
    constexpr int steps = 200;  // Simpson's rule on less than one lobe of sinc²: to 1e-9
    double sum = 0;
    for (int i = 0; i <= steps; ++i) {
      const double x = half * (2.0 * i / steps - 1), u = x / (lambda * std::hypot(x, distance));
      const double a = pi * lit * pitch * (u + carrier), s = a == 0 ? 1 : std::sin(a) / a;
      sum += s * s * (i == 0 || i == steps ? 1 : i % 2 ? 4 : 2);
    }
    return sum * 2 * half / (3.0 * steps) / side;
  };
  const double open = 1 / pitch;
  const auto& filter = light.filter;
  const double lit_x = light.losses.by_pixels ? slm.lit_x() : 0, lit_y = light.losses.by_pixels ? slm.lit_y() : 0;
  return along(std::min(slm.grid.width(), seen), lit_x, filter ? filter->half_u : open, filter ? filter->u0 : 0) *
         along(std::min(slm.grid.height(), seen), lit_y, filter ? filter->half_v : open, filter ? filter->v0 : 0);
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
  const double step = 2 * half_tangent / render.ny * std::abs(distance);  // side of a render pixel on the sensor [m]
  if (step <= 0) return out;
  const double ratio = sensor.pitch / step;
  const int parts = std::clamp(int(std::ceil(ratio)), 1, 32);  // places of the render per sensor pixel and axis
  parallel_for(0, out.ny, [&](int64_t j) {
    for (int i = 0; i < out.nx; ++i) {
      double sums[3] = {0, 0, 0};
      for (int b = 0; b < parts; ++b)
        for (int a = 0; a < parts; ++a) {
          const double x = i + (a + 0.5) / parts - 0.5, y = double(j) + (b + 0.5) / parts - 0.5;
          add_between(render, (y - (out.ny - 1) / 2.0) * ratio - sensor.centre_y / step + (render.ny - 1) / 2.0,
                      (x - (out.nx - 1) / 2.0) * ratio + sensor.centre_x / step + (render.nx - 1) / 2.0, sums);
        }
      for (int channel = 0; channel < std::min(out.channels, 3); ++channel)
        out(int(j), i, channel) = float(sums[channel] / (parts * parts));
    }
  });
  return out;
}

}  // namespace holotrace
