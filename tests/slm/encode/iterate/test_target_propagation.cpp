#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "support/panels.h"
#include "support/targets.h"

namespace holotrace {
namespace {

Grid finer(const Grid& grid, int n) { return {grid.nx * n, grid.ny * n, grid.pitch / n}; }

// Names that a failure shows, with the optics.
using Case = std::pair<std::string, TargetOptics>;

std::vector<Case> all_optics() {
  const Pupil on_axis{{0, 0, 0.004}, 0.00012}, off_axis{{0.00007, -0.00011, 0.006}, 0.0002};
  return {{"middle", {}},
          {"without aperture", {.aperture = PixelAperture::left_out}},
          {"diagonal", {.samples = PixelSamples::diagonal}},
          {"four", {.samples = PixelSamples::four}},
          {"stop", {.samples = PixelSamples::diagonal, .stop = 0.4}},
          {"subpixels", {.aperture = PixelAperture::left_out, .subpixels = 3}},
          {"subpixels, stop", {.aperture = PixelAperture::left_out, .subpixels = 3, .stop = 0.5}},
          {"pupil", {.samples = PixelSamples::diagonal, .pupil = on_axis}},
          {"pupil off the axis", {.samples = PixelSamples::four, .pupil = off_axis}},
          {"pupil, stop", {.samples = PixelSamples::diagonal, .stop = 0.5, .pupil = off_axis}},
          {"pupil, subpixels", {.aperture = PixelAperture::left_out, .subpixels = 3, .pupil = off_axis}}};
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

}  // namespace
}  // namespace holotrace
