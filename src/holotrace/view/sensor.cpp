#include "holotrace/view/sensor.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/view/expose.h"
#include "holotrace/wave/propagate/propagate.h"

namespace holotrace {
namespace {

// Samples of the sensor's window along one axis: the present number plus or minus an even number.
int window_samples(double size, double pitch, int present) {
  if (size == 0) return present;
  const double wanted = present + 2 * std::round((size / pitch - present) / 2);
  require(wanted >= 1, "expected a sensor at least one sample of {} wide and high, got a side of {}",
          format_length(pitch), format_length(size));
  require(wanted < 1e9, "expected a sensor of less than 1e9 samples a side, got a side of {} in samples of {}",
          format_length(size), format_length(pitch));
  return int(wanted);
}

// Whole pixels of a sensor along one axis.
int sensor_pixels(double size, double pixel) {
  const double wanted = std::round(size / pixel);
  require(wanted >= 1, "expected a sensor at least one pixel of {} wide and high, got a side of {}",
          format_length(pixel), format_length(size));
  require(wanted < 1e9, "expected a sensor of less than 1e9 pixels a side, got a side of {} in pixels of {}",
          format_length(size), format_length(pixel));
  return int(wanted);
}

// The pixel grid for the camera's width, height and pixel size.
Grid pixels_of_side(const Slm& slm, const CameraParams& camera) {
  return {sensor_pixels(camera.width > 0 ? camera.width : slm.grid.width(), camera.pixel),
          sensor_pixels(camera.height > 0 ? camera.height : slm.grid.height(), camera.pixel), camera.pixel,
          camera.centre_x, camera.centre_y};
}

// The light at a point of the sensor comes from the panel and through the pupil. The field's band there is at most
// side/λz for the side of either aperture, and at most the 1/pitch of the shown field.
int samples_per_pixel(const Grid& shown, double pixel, double wavelength, double z, const CameraParams& camera,
                      const PropagateParams& propagation) {
  double resolved = shown.pitch;
  if (!propagation.is_periodic)
    resolved = std::max(resolved, wavelength * std::abs(z) / std::max(shown.width(), shown.height()));
  if (camera.pupil > 0) resolved = std::max(resolved, wavelength * std::abs(z - camera.eye.z) / camera.pupil);
  if (3 * pixel <= resolved * (1 + 1e-9)) return 1;
  return std::max(2, int(std::ceil(2 * pixel / resolved * (1 - 1e-9))));
}

}  // namespace

Grid pixels_of(const Grid& samples, int n, const Observer& observer) {
  check_grid(samples);
  const int side = std::min(samples.nx, samples.ny);
  require(n >= 1 && n <= side, "expected a binning of 1 to {} samples, the side of the field, or 0 for 1, got {}", side,
          n);
  const int spare_x = samples.nx % n, spare_y = samples.ny % n;
  if (spare_x || spare_y)
    observer.warn(fmt::format(
        "the field of {} × {} samples does not divide into bins of {} × {}: only {} × {} samples of it are used; "
        "choose a binning that divides both numbers",
        samples.nx, samples.ny, n, n, samples.nx - spare_x, samples.ny - spare_y));
  return {samples.nx / n, samples.ny / n, n * samples.pitch, samples.centre_x - (spare_x % 2) * samples.pitch / 2,
          samples.centre_y + (spare_y % 2) * samples.pitch / 2};
}

PropagateParams window_of(const Grid& pixels, int n, int rim, PropagateParams propagation) {
  require(
      double(n) * std::max(pixels.nx, pixels.ny) + 2.0 * rim < 1e9,
      "expected a sensor of less than 1e9 samples a side, got {} × {} pixels of {} samples a side and {} beyond them",
      pixels.nx, pixels.ny, n, rim);
  propagation.columns = n * pixels.nx + 2 * rim;
  propagation.rows = n * pixels.ny + 2 * rim;
  propagation.pitch = pixels.pitch / n;
  propagation.centre_x = pixels.centre_x;
  propagation.centre_y = pixels.centre_y;
  return propagation;
}

Sensor sensor_of(const FieldShape& shown, const Slm& slm, double z, const PropagateParams& propagation,
                 const CameraParams& camera, double blur, const Observer& observer) {
  const Grid& samples = shown.grid;
  const bool has_window =
      camera.width != 0 || camera.height != 0 || camera.pixel != 0 || camera.centre_x != 0 || camera.centre_y != 0;
  require(!has_window || (propagation.columns == 0 && propagation.rows == 0 && propagation.pitch == 0 &&
                          propagation.centre_x == 0 && propagation.centre_y == 0),
          "expected the sensor's window either by the camera's width, height, centre and pixel or by the "
          "propagation's columns, rows, centre and pitch, got both; leave one out");
  Sensor sensor;
  int given = camera.binning;  // samples per pixel, if given
  if (camera.pixel != 0) {
    sensor.pixels = pixels_of_side(slm, camera);
  } else {
    if (given == 0) given = std::max(1, int(std::lround(slm.grid.pitch / samples.pitch)));
    PropagateParams window = propagation;
    if (has_window) {
      window.columns = window_samples(camera.width, samples.pitch, samples.nx);
      window.rows = window_samples(camera.height, samples.pitch, samples.ny);
      window.centre_x = camera.centre_x;
      window.centre_y = camera.centre_y;
    }
    sensor.pixels = pixels_of(propagation_output(samples, window), given, observer);
  }
  sensor.is_integrated = camera.sampling == PixelSampling::integrate;
  const int least = sensor.is_integrated
                        ? samples_per_pixel(samples, sensor.pixels.pitch, shown.wavelength, z, camera, propagation)
                        : 1;
  sensor.samples = std::max(given, least);
  const double blurred = std::ceil(blur / sensor.pixels.pitch * sensor.samples);
  require(blurred < 1e9, "expected a source whose image on the sensor is less than 1e9 samples wide, got {:.3g}",
          2 * blurred);
  sensor.blur = int(blurred);
  sensor.rim = sensor.blur + (sensor.is_integrated ? integration_rim : 0);
  sensor.window = window_of(sensor.pixels, sensor.samples, sensor.rim, propagation);
  return sensor;
}

namespace {

// Random bits from a CounterRandom, with the interface that the standard library's distributions need.
struct Bits {
  using result_type = uint32_t;
  static constexpr uint32_t min() { return 0; }
  static constexpr uint32_t max() { return 0xffffffffu; }
  uint32_t operator()() { return uint32_t(random.uniform() * 0x1p32); }

  CounterRandom random;
};

}  // namespace

void check_sensor(const CameraParams& camera) {
  check_ranges(camera);
  require(camera.read_noise == 0 || camera.electrons > 0,
          "expected electrons above 0 with a read noise of {} electrons, got 0; set electrons", camera.read_noise);
}

Image add_sensor_noise(const Image& view, double white, const CameraParams& camera, uint32_t exposure) {
  check_sensor(camera);
  if (camera.electrons == 0) return view;
  require(std::isfinite(white) && white > 0, "expected a white above 0 W/m², got {} W/m²", white);
  Image reading = view;
  const size_t row = size_t(view.nx) * size_t(view.channels);
  parallel_for(0, view.ny, [&](int64_t j) {
    for (size_t i = size_t(j) * row; i < size_t(j + 1) * row; ++i) {
      Bits bits{CounterRandom(uint64_t(camera.noise_seed), exposure, i)};
      const double mean = std::max(0.0, camera.electrons * double(view.values[i]) / white);
      double electrons = mean > 0 ? double(std::poisson_distribution<int64_t>(mean)(bits)) : 0;
      if (camera.read_noise > 0) electrons += std::normal_distribution<double>(0, camera.read_noise)(bits);
      reading.values[i] = float(std::clamp(electrons, 0.0, camera.electrons) / camera.electrons * white);
    }
  });
  return reading;
}

}  // namespace holotrace
