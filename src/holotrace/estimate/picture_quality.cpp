#include "holotrace/estimate/picture_quality.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/panel/illumination.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/diffraction_orders.h"
#include "holotrace/view/expose.h"
#include "holotrace/view/sensor.h"
#include "holotrace/wave/propagate/propagate.h"

namespace holotrace {
namespace {

// Noise of mean 0 and variance 1 whose amplitude spectrum falls as 1/f.
Array2D<float> natural_noise(int columns, int rows, uint64_t seed) {
  Array2D<std::complex<float>> spectrum(rows, columns);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const double f =
          std::hypot(double(signed_frequency(i, columns)) / columns, double(signed_frequency(j, rows)) / rows);
      CounterRandom random(seed, 0, uint64_t(j) * uint64_t(columns) + uint64_t(i));
      if (f > 0) spectrum(j, i) = std::complex<float>(std::polar(1 / f, 2 * pi * random.uniform()));
    }
  fft_2d(spectrum.values.data(), rows, columns, FftDirection::backward);
  double square = 0;
  for (const auto& u : spectrum.values) square += double(u.real()) * u.real();
  const double scale = 1 / std::sqrt(square / double(spectrum.size()));
  Array2D<float> noise(rows, columns);
  for (size_t i = 0; i < noise.size(); ++i) noise.values[i] = float(scale * spectrum.values[i].real());
  return noise;
}

struct Ball {
  double x, y, radius, light;
};

}  // namespace

Image natural_picture(int columns, int rows) {
  Image picture(rows, columns, 1);
  const Array2D<float> far = natural_noise(columns, rows, 1), near = natural_noise(columns, rows, 2);
  const Ball balls[] = {{0.25, 0.55, 0.17, 0.95}, {0.46, 0.72, 0.11, 0.5}, {0.62, 0.45, 0.14, 0.25}};
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const double y = double(j) / rows, x = double(i) / rows;  // both in units of the height
      const double across = double(i) / columns;
      double light = y < 0.45 + 0.03 * double(near(j, i)) ? 0.55 - 0.5 * y + 0.06 * double(far(j, i))
                                                          : 0.22 + 0.11 * double(near(j, i));
      for (const Ball& ball : balls) {
        const double dx = (x - ball.x * columns / rows) / ball.radius, dy = (y - ball.y) / ball.radius;
        const double r2 = dx * dx + dy * dy;
        if (r2 >= 1) continue;
        const double facing = std::max(0.0, 0.5 * std::sqrt(1 - r2) - 0.5 * dx - 0.7 * dy);
        light = ball.light * (0.04 + facing) * (1 + 0.1 * double(far(j, i)));
      }
      if (across > 0.8 && across < 0.95 && y > 0.15 && y < 0.85) {  // five rows of bars, each twice as wide
        const int width = std::max(2, rows / 220) << std::min(4, int((y - 0.15) / 0.14));
        light = i / width % 2 ? 0.9 : 0.05;
      }
      picture(j, i) = float(std::clamp(light, 0.0, 1.0));
    }
  return picture;
}

EncoderQuality encoder_quality(const TargetPlane& target, const Hologram& hologram, const Slm& slm,
                               const ShowParams& params, PixelSampling sampling) {
  require(params.subpixels == 1, "expected 1 sample per pixel, as the target has, got {}", params.subpixels);
  const bool is_integrated = sampling == PixelSampling::integrate;
  const int samples = is_integrated ? 2 : 1, rim = is_integrated ? integration_rim : 0;
  // The irradiance of all illumination states; a panel with flicker has several.
  std::vector<double> irradiance(target.amplitude.size());
  for (const IlluminationState& state :
       illumination_states(with_effects_or_own(slm, params.effects), params, hologram.wavelength)) {
    Field light = show(hologram, slm, params, state);
    const PropagateParams window = window_of(light.grid, samples, rim);
    if (light.filter) light = apply_order_stop(light, *light.filter, order_stop_margin(*light.filter, light.grid));
    light = propagate(light, target.z, window);
    const Image seen = mean_over_pixels(irradiance_of(light), samples, rim, is_integrated);
    for (size_t i = 0; i < irradiance.size(); ++i) irradiance[i] += state.weight * double(seen.values[i]);
  }
  double wanted = 0, cross = 0, square = 0, weight = 0, peak = 0;
  for (size_t i = 0; i < target.amplitude.size(); ++i) {
    const double w = target.weight.size() == 0 ? 1 : double(target.weight.values[i]);
    if (w <= 0) continue;
    const double a = target.amplitude.values[i], v = std::sqrt(irradiance[i]);
    wanted += w * a * a;
    cross += w * a * v;
    square += w * v * v;
    weight += w;
    peak = std::max(peak, a);
  }
  const double error = std::max(square > 0 ? wanted - cross * cross / square : wanted, 1e-15 * wanted);
  return {10 * std::log10(peak * peak * weight / error), square / double(slm.grid.pixels())};
}

double picture_noise(const Image& a, const Image& b) {
  require(a.nx == b.nx && a.ny == b.ny && a.channels == b.channels,
          "expected two pictures of one size, got {} × {} and {} × {} pixels", a.nx, a.ny, b.nx, b.ny);
  double error = 0, light = 0;
  for (size_t i = 0; i < a.values.size(); ++i) {
    const double difference = double(a.values[i]) - b.values[i], mean = (double(a.values[i]) + b.values[i]) / 2;
    error += difference * difference / 2;
    light += mean * mean;
  }
  require(light > 0, "expected pictures with light, got dark ones");
  return std::sqrt(error / light);
}

}  // namespace holotrace
