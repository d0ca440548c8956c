#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "holotrace/base/units.h"
#include "holotrace/data/shapes.h"
#include "holotrace/run/renders.h"
#include "holotrace/trace/focal_stack.h"
#include "holotrace/trace/trace.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {
namespace {

constexpr double green_laser = 532e-9;

// A background of radiance 2; the quad, which a scene must have, is out of view.
Sources waves_of_background(const Grid& panel) {
  Scene scene;
  scene.materials = {DiffuseMaterial{}};
  scene.meshes = {make_quad(1e-3, 1e-3)};
  for (Vec3& place : scene.meshes.front().positions) place += Vec3{1, 0, -0.3};
  scene.background = {2, 2, 2};
  return trace(scene, panel, green_laser, {.columns = 3, .rows = 1, .paths = 1, .has_background = true});
}

// The part of a field that is a plane wave from the unit direction n (z < 0): the mean of U·exp(ik·n·p). A lens of the focal
// length f brings it to the place −f·(n.x, n.y)/n.z of its focal plane.
std::complex<double> plane_part(const Field& field, Vec3 n) {
  const double k = 2 * pi / field.wavelength;
  std::complex<double> sum;
  for (int row = 0; row < field.grid.ny; ++row)
    for (int column = 0; column < field.grid.nx; ++column)
      sum += std::complex<double>(field.samples(row, column)) *
             std::polar(1.0, k * (n.x * field.grid.x(column) + n.y * field.grid.y(row)));
  return sum / double(field.grid.pixels());
}

TEST(BackgroundField, IsMadeOfPlaneWavesByEveryMethod) {
  const Grid panel{192, 128, 8e-6};
  const Sources sources = waves_of_background(panel);
  ASSERT_EQ(sources.waves.size(), 3u);
  for (const SynthesisMethod method : {SynthesisMethod::exact, SynthesisMethod::tiled, SynthesisMethod::planes}) {
    const Field field = synthesize(sources, panel, {.method = method, .tolerance = 1e-3});
    double power = 0, plane = 0;
    for (const Source& wave : sources.waves) {
      const Vec3 n = normalize(wave.origin);
      const double found = std::abs(plane_part(field, n)), cosine = -n.z;
      // Waves 0.022 apart in the sine of their angles overlap by λ/(π·0.022·1.5 mm) = 0.5 % of each other. √(L·dΩ) is the
      // amplitude by tangents: cells of (2T/3) by 2T.
      const double tangent = std::tan(std::asin(green_laser / 16e-6));
      const double expected = std::sqrt(2 * 2 * tangent * 2 * tangent / 3) * cosine * cosine;
      EXPECT_NEAR(found / expected, 1, 0.011) << "two neighbours of each";
      plane += found * found;
    }
    for (const std::complex<float> sample : field.samples.values) power += std::norm(std::complex<double>(sample));
    EXPECT_NEAR(plane / (power / double(panel.pixels())), 1, 0.03) << "nothing else is there; twice the overlaps above";
  }
}

TEST(BackgroundField, IsPlaneToAHundredthOfAWave) {
  // One wave of the three over 15 mm: the deviation from a plane is r²/2d, 3·10⁻⁹ m at the edge.
  const Grid panel{1920, 8, 8e-6};
  Sources sources = waves_of_background(panel);
  sources = some_of(sources, {1});
  const Field field = synthesize(sources, panel, {.method = SynthesisMethod::exact});
  const Vec3 n = normalize(sources.waves.front().origin);
  const std::complex<double> part = plane_part(field, n), first(field.samples(4, 0));
  const double off = std::arg(first * std::polar(1.0, 2 * pi / green_laser * n.x * panel.x(0)) / part);
  EXPECT_LT(std::abs(off), 2 * pi / 100);
  EXPECT_GT(std::abs(off), 2 * pi / 2000) << "the sag is there: a third of it is in the mean";
}

TEST(BackgroundField, ReferencesAndTargetsShowItAsTheHologramDoes) {
  Job job;
  EXPECT_FALSE(light_of_waves(job, job.render).has_background);
  job.trace.has_background = true;
  EXPECT_TRUE(light_of_waves(job, job.render).has_background);

  Scene scene;
  scene.materials = {DiffuseMaterial{}};
  scene.meshes = {make_quad(1e-3, 1e-3)};
  for (Vec3& place : scene.meshes.front().positions) place += Vec3{1, 0, -0.3};
  scene.background = {2, 2, 2};
  const Grid panel{32, 24, 8e-6};
  for (const bool is_shown : {true, false}) {
    const RenderParams params{.paths = 4, .has_background = is_shown};
    const FocalStack stack = trace_focal_stack(scene, panel, green_laser, {0.3, 2}, params);
    for (const Image& picture : stack.pictures)
      for (const float value : picture.values)
        EXPECT_NEAR(value, is_shown ? 2 : 0, 1e-6) << "an even background is even out of focus";
  }
}

// What is compared with the light of one laser has the index of glass at its wavelength; colours have their own.
TEST(LightOfWaves, OfOneLaserHasTheIndicesAtItsWavelength) {
  Job job;
  job.wavelengths = {633e-9};
  EXPECT_EQ(light_of_waves(job, job.render).glass_wavelength, 633e-9);
  job.wavelengths = {638e-9, 532e-9, 450e-9};
  EXPECT_EQ(light_of_waves(job, job.render).glass_wavelength, 0);
}

}  // namespace
}  // namespace holotrace
