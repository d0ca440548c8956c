#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/calibration.h"
#include "holotrace/data/image.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/expose.h"
#include "holotrace/view/sensor.h"
#include "holotrace/wave/propagate/propagate.h"

// Photographs of patterns on a hidden panel, by a camera that is turned, scaled and shifted. The resampling to the
// camera's pixels is a sum over points of a fine grid and shares nothing with calibrate/.

namespace holotrace {

inline constexpr double bench_wavelength = 633e-9;

/// A panel with none of the differences that a calibration looks for.
inline Slm assumed_panel(int nx, int ny, double fill_factor = 0.93) {
  return {.name = "assumed", .grid = {nx, ny, 8e-6}, .levels = 256, .fill_factor = fill_factor};
}

/// The phase of the hidden panel at a level [rad]: S-shaped, and 12 % too deep.
inline double hidden_phase(double level) {
  const double t = level / 256;
  return 1.12 * 2 * pi * t - 0.3 * std::sin(2 * pi * t) * (1 - 0.5 * t);
}
inline double hidden_light(double x, double y) {  // x, y in −1 … 1
  return 1.4 * std::exp(-((x - 0.2) * (x - 0.2) + (y + 0.1) * (y + 0.1)) / 1.8);
}

inline Slm hidden_panel(int nx, int ny) {
  Slm slm = assumed_panel(nx, ny, 0.9);
  slm.name = "hidden";
  slm.design_wavelength = bench_wavelength;
  for (int level = 0; level < 256; ++level)
    slm.effects.calibration.push_back({hidden_phase(level), 1 - 0.04 * std::pow(std::sin(pi * level / 256.0), 2)});
  slm.effects.crosstalk = 0.3;
  slm.effects.gap_amplitude = 0.6;
  slm.effects.gap_phase = 0.7;
  slm.effects.aberration = {{2, 0, 0.5}, {2, 2, -0.4}, {2, -2, 0.2}, {3, -1, 0.25}, {3, 3, -0.15}};
  Array2D<float> light(ny, nx);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) light(j, i) = float(hidden_light((2 * i + 1.0) / nx - 1, 1 - (2 * j + 1.0) / ny));
  slm.effects.light_map = std::make_shared<const Array2D<float>>(light);
  return slm;
}

struct TestCamera {
  double pixel = 6e-6;                   ///< [m]
  double rotation = 2.4;                 ///< of the panel in the photograph, anticlockwise [rad]
  double shift_x = 3.3, shift_y = -4.6;  ///< [pixels]
  int nx = 230, ny = 220;
  double electrons = 20000;  ///< full well; 0: no noise and no rounding
  double blur = 0;           ///< variance of the lens's blur per axis, below 0.5 [pixels²]
};

/// The irradiance at samples of a quarter of the panel's pitch.
inline Image fine_irradiance(const Hologram& pattern, const Slm& panel, double distance) {
  ShowParams params;
  params.effects = {"all"};
  Hologram shown = pattern;
  const Field left = show(shown, panel, params);
  PropagateParams window;
  window.pitch = panel.grid.pitch / 4;
  window.columns = 5 * panel.grid.nx;
  window.rows = 5 * panel.grid.ny;
  const Field there = propagate(left, distance, window);
  Image image(there.grid.ny, there.grid.nx, 1);
  const Array2D<float> values = irradiance_of(there);
  image.values.assign(values.values.begin(), values.values.end());
  image.pitch = there.grid.pitch;
  return image;
}

/// The photograph in [0, 1]: 4 × 4 points per pixel with bilinear interpolation; the brightest 0.05 % are near white, a
/// dark level of 0.4 %, shot and read noise, and 8 bits in steps of the amplitude, as sRGB's nearly are.
inline Image photograph_of(const Image& fine, const TestCamera& camera, uint32_t exposure) {
  Image photo(camera.ny, camera.nx, 1);
  const double c = std::cos(camera.rotation), s = std::sin(camera.rotation);
  for (int j = 0; j < camera.ny; ++j)
    for (int i = 0; i < camera.nx; ++i) {
      double sum = 0;
      for (int k = 0; k < 16; ++k) {
        const double u = i - (camera.nx - 1) / 2.0 + (k % 4 - 1.5) / 4 - camera.shift_x,
                     v = (camera.ny - 1) / 2.0 - j + (k / 4 - 1.5) / 4 - camera.shift_y;
        const double x = camera.pixel * (c * u + s * v) / fine.pitch + (fine.nx - 1) / 2.0,
                     y = (fine.ny - 1) / 2.0 - camera.pixel * (-s * u + c * v) / fine.pitch;
        const int left = int(std::floor(x)), top = int(std::floor(y));
        if (left < 0 || top < 0 || left + 1 >= fine.nx || top + 1 >= fine.ny) continue;
        const double tx = x - left, ty = y - top;
        sum += (1 - ty) * ((1 - tx) * fine(top, left) + tx * fine(top, left + 1)) +
               ty * ((1 - tx) * fine(top + 1, left) + tx * fine(top + 1, left + 1));
      }
      photo(j, i) = float(sum / 16);
    }
  if (camera.blur > 0) {  // four neighbours of the weight v/2 each: the variance v along either axis
    const Image sharp = photo;
    for (int j = 1; j + 1 < photo.ny; ++j)
      for (int i = 1; i + 1 < photo.nx; ++i) {
        const float around = sharp(j - 1, i) + sharp(j + 1, i) + sharp(j, i - 1) + sharp(j, i + 1);
        photo(j, i) = float(1 - 2 * camera.blur) * sharp(j, i) + float(camera.blur / 2) * around;
      }
  }
  std::vector<float> sorted = photo.values;
  std::sort(sorted.begin(), sorted.end());
  const float white = sorted[size_t(0.9995 * double(sorted.size()))] / 0.95F;
  for (float& value : photo.values) value = std::min(1.0F, value / white + 0.004F);
  if (camera.electrons == 0) return photo;
  CameraParams noise;
  noise.electrons = camera.electrons;
  noise.read_noise = 10;
  photo = add_sensor_noise(photo, 1, noise, exposure);
  for (float& value : photo.values) value = std::pow(std::round(255 * std::sqrt(value)) / 255, 2.0F);
  return photo;
}

inline std::vector<Image> photographs_of(const CalibrationPlan& plan, const Slm& panel, const TestCamera& camera) {
  std::vector<Image> photos;
  for (const TestPattern& pattern : plan.patterns)
    photos.push_back(
        photograph_of(fine_irradiance(pattern.hologram, panel, plan.distance), camera, uint32_t(photos.size())));
  return photos;
}

}  // namespace holotrace
