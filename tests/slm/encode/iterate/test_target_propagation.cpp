#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/random.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/fields.h"
#include "support/panels.h"
#include "support/targets.h"

namespace holotrace {
namespace {

Grid finer(const Grid& grid, int n) { return {grid.nx * n, grid.ny * n, grid.pitch / n}; }

// Names that a failure shows, with the optics.
using Case = std::pair<std::string, TargetOptics>;

std::vector<Case> all_optics() {
  return {{"middle", {}},
          {"without aperture", {.aperture = PixelAperture::left_out}},
          {"diagonal", {.samples = PixelSamples::diagonal}},
          {"four", {.samples = PixelSamples::four}},
          {"stop", {.samples = PixelSamples::diagonal, .stop = 0.4}},
          {"subpixels", {.aperture = PixelAperture::left_out, .subpixels = 3}},
          {"subpixels, stop", {.aperture = PixelAperture::left_out, .subpixels = 3, .stop = 0.5}}};
}

TEST(TargetPropagation, WayBackIsTheAdjointOfTheWayThere) {
  // Angular spectrum (2 mm) and Rayleigh–Sommerfeld kernel (0.2 m), to either side, with all that is in the way. Float
  // sums of a few thousand products: 1e-5 of the norms. g is half the light itself, so that the products are large.
  const Slm slm = make_panel(72, 40, 256, 0.9);
  for (const auto& [name, optics] : all_optics())
    for (const double z : {-0.002, 0.002, -0.2, 0.2}) {
      const TargetPropagation propagation(slm, test_wavelength, z, optics);
      const Field u = random_field(finer(slm.grid, optics.subpixels), 1);
      const std::vector<Field> shown = propagation.to_plane(u);
      std::vector<Field> g;
      std::complex<double> there = 0;
      double of_g = 0, of_light = 0;
      for (size_t i = 0; i < shown.size(); ++i) {
        const double light = inner(shown[i], shown[i]).real();
        Field noise = random_field(shown[i].grid, 2 + i);
        const double modulus = std::sqrt(light / inner(noise, noise).real());
        for (size_t n = 0; n < noise.samples.size(); ++n)
          noise.samples.values[n] = float(modulus) * noise.samples.values[n] + shown[i].samples.values[n];
        there += inner(noise, shown[i]);
        of_g += inner(noise, noise).real();
        of_light += light;
        g.push_back(std::move(noise));
      }
      const std::complex<double> back = inner(propagation.to_panel(g), u);
      EXPECT_LT(std::abs(there - back), 1e-5 * std::sqrt(of_light * of_g)) << name << ", " << z;
      EXPECT_GT(std::abs(there), 0.5 * std::sqrt(of_light * of_g)) << name;  // 1/√2 ± the noise's part along the light
    }
}

TEST(TargetPropagation, NoLightIsGained) {
  // ‖T‖ ≤ 1, from which it follows that the error of Gerchberg and Saxton's method never grows. 1e-5: float.
  const Slm slm = make_panel(72, 40);
  for (const auto& [name, optics] : all_optics())
    for (const double z : {0.0, 0.002, -0.2}) {
      const Field u = random_field(finer(slm.grid, optics.subpixels), 3);
      double light = 0;
      for (const Field& v : TargetPropagation(slm, test_wavelength, z, optics).to_plane(u)) light += inner(v, v).real();
      EXPECT_LE(light, inner(u, u).real() * (1 + 1e-5)) << name << ", " << z;
    }
}

// A wave of f cycles per pixel along x under a wide Gaussian, on n samples per pixel: a line of its spectrum is 1/20
// of the band wide at e⁻¹⁸ of its power.
Field wave_packet(const Grid& pixels, int n, double f) {
  Field field(finer(pixels, n), test_wavelength);
  const double width = pixels.width() / 8;
  for (int j = 0; j < field.grid.ny; ++j)
    for (int i = 0; i < field.grid.nx; ++i) {
      const double x = field.grid.x(i), y = field.grid.y(j), modulus = std::exp(-(x * x + y * y) / (2 * width * width));
      field.samples(j, i) = std::complex<float>(std::polar(modulus, 2 * pi * f * x / pixels.pitch));
    }
  return field;
}

double light_of(const std::vector<Field>& samples) {
  double light = 0;
  for (const Field& v : samples) light += inner(v, v).real();
  return light;
}

TEST(TargetPropagation, PowerIsTheMeanIrradianceOverAPixel) {
  // A slow wave keeps its irradiance, in whatever way it is sampled: 1 in the middle, times w_x²w_y² = F² = 0.81 where the
  // aperture of the pixels is included. Beside the middle the Gaussian falls by (p/2)²/width² = 0.1 % of the irradiance.
  const Slm slm = make_panel(128, 128, 256, 0.9);
  for (const auto& [name, optics] : all_optics()) {
    const TargetPropagation propagation(slm, test_wavelength, 0, optics);
    const Array2D<float> power = power_of(propagation.to_plane(wave_packet(slm.grid, optics.subpixels, 0)), slm.grid);
    EXPECT_NEAR(power(64, 64), optics.aperture == PixelAperture::included ? 0.81 : 1, 0.003) << name;
  }
}

TEST(TargetPropagation, AStopOfOnePassesAllOrdersAndANarrowOneThoseWithinIt) {
  // Waves in the middle of order 1 (f = 1) and near the edge of order 0. A stop of 0.5 ends at f = 0.25.
  const Slm slm = make_panel(128, 128);
  for (const auto& [subpixels, f] : {std::pair(1, 0.2), {1, 0.3}, {3, 0.2}, {3, 0.3}, {3, 0.6}, {3, 1.0}, {3, 1.4}})
    for (const double stop : {1.0, 0.5}) {
      const TargetOptics optics{.aperture = PixelAperture::left_out, .subpixels = subpixels, .stop = stop};
      const Field u = wave_packet(slm.grid, subpixels, f);
      const double passed = light_of(TargetPropagation(slm, test_wavelength, 0, optics).to_plane(u)) * subpixels *
                            subpixels / inner(u, u).real();
      EXPECT_NEAR(passed, stop == 1 || f < 0.25 ? 1 : 0, 1e-3) << subpixels << " " << f << " " << stop;
    }
}

TEST(TargetPropagation, PixelsIntegrateSpeckle) {
  // Fully developed speckle of the panel's whole band ±1/2p. Its irradiance has a triangular spectrum Λ(pu)Λ(pv), so the
  // error of a rule that weighs it by h instead of sinc·sinc has the variance ∫∫ΛΛ(h − sinc·sinc)², over the squared mean:
  // 0.483 of the mean for the middle alone, 0.304 for two samples, 0.065 for four. The light itself varies by 0.656.
  // 64 × 64 pixels: 1/64 of an rms, times √2 for correlated neighbours; 8 % is three of those and more.
  const Slm slm = make_panel(128, 128);
  const Field u = random_field(slm.grid, 1);
  constexpr int fine = 16;
  PropagateParams finer;
  finer.columns = finer.rows = 128 * fine;
  finer.pitch = test_pitch / fine;
  const Field field = propagate(u, 0.002, finer);
  double mean = 0;
  Array2D<double> integral(128, 128);
  for (int j = 32 * fine; j < 96 * fine; ++j)
    for (int i = 32 * fine; i < 96 * fine; ++i)
      integral(j / fine, i / fine) += double(std::norm(field.samples(j, i))) / (fine * fine);
  for (const double value : integral.values) mean += value / (64 * 64);
  for (const auto& [samples, expected] :
       {std::pair(PixelSamples::middle, 0.4826), {PixelSamples::diagonal, 0.3043}, {PixelSamples::four, 0.0648}}) {
    const TargetPropagation propagation(slm, test_wavelength, 0.002,
                                        {.aperture = PixelAperture::left_out, .samples = samples});
    const Array2D<float> power = power_of(propagation.to_plane(u), slm.grid);
    double square = 0;
    for (int j = 32; j < 96; ++j)
      for (int i = 32; i < 96; ++i) square += std::pow(double(power(j, i)) - integral(j, i), 2) / (64 * 64);
    EXPECT_NEAR(std::sqrt(square) / mean, expected, 0.08 * expected) << int(samples);
  }
}

// Fringes of f cycles per pixel along x and g along y, at the four samples of each pixel: the mean over a pixel multiplies
// them by sinc(f)·sinc(g). Its weights are within 0.013 of sinc along each axis, so their product is within 0.026. The four
// samples alone are 0.087 off.
TEST(PixelMeans, FringesHaveTheContrastOfTheirMeanOverAPixel) {
  const int n = 24;
  for (const auto& [f, g] : {std::pair{0.25, 0.0}, {0.0, 0.5}, {0.75, 0.0}, {0.5, 0.75}, {1.0, 0.25}}) {
    SamplePower power;
    for (size_t s = 0; s < 4; ++s) {
      power[s] = Array2D<float>(n, n);
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const double x = i + (s % 2 == 0 ? -0.25 : 0.25), y = j + (s < 2 ? -0.25 : 0.25);
          power[s](j, i) = float((1 + std::cos(2 * pi * f * x) * std::cos(2 * pi * g * y)) / 4);
        }
    }
    const Array2D<float> means = pixel_means(power);
    double most = 0;
    for (int j = 1; j + 1 < n; ++j)  // pixels at the edges lack a neighbour
      for (int i = 1; i + 1 < n; ++i)
        most = std::max(
            most, std::abs(means(j, i) - 1 - sinc(f) * sinc(g) * std::cos(2 * pi * f * i) * std::cos(2 * pi * g * j)));
    EXPECT_LT(most, 0.026) << f << ' ' << g;
  }
}

}  // namespace
}  // namespace holotrace
