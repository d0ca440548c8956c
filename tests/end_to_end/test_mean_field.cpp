// Scene → Sources → Field: both strategies estimate the same mean field.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "holotrace/base/cycles.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/trace/gather.h"
#include "holotrace/trace/trace.h"
#include "holotrace/trace/waves/source_phase.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/synthesize.h"
#include "support/fields.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

using Complex = std::complex<double>;
using test::relative_error;

// --- Monte Carlo with phase: both strategies estimate the same mean field ------------------------
// With one wave per ray, a field is a sum of independent waves, whose mean grows as √N.

const Grid small{64, 64, 8e-6};
constexpr double wall_depth = 20e-3, half = 0.15e-3, grain = 0.1e-3;

/// A patch of radiance 1 whose boxes contain every pixel: 0.15 + 0.256 mm < R = 20 mm·tan(asin(λ/2p)) = 0.67 mm.
Scene make_patch() {
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_wall(-wall_depth, half, half)};
  return scene;
}

/// M(p) = (√L/2s)·∫ cos²θ/r²·exp(i(kr + φ)) dS, the mean of U/√N of both strategies; midpoint rule in steps of 2 µm.
FieldDouble make_mean_field(double& irradiance) {
  const double s = acceptance_sine(green_light, small.pitch);
  constexpr int cells = 150;
  const double step = 2 * half / cells;
  FieldDouble field(small, green_light);
  irradiance = 0;
  for (int j = 0; j < small.ny; ++j)
    for (int i = 0; i < small.nx; ++i) {
      Complex sum = 0;
      for (int b = 0; b < cells; ++b)
        for (int a = 0; a < cells; ++a) {
          const Vec3 o{(a + 0.5) * step - half, (b + 0.5) * step - half, -wall_depth};
          const double phase = random_phase(1, 0, surface_phase_key(o, grain));
          const Vec3 way = o - Vec3{small.x(i), small.y(j), 0};
          const double r2 = dot(way, way), r = std::sqrt(r2),
                       weight = wall_depth * wall_depth / (r2 * r2) * step * step;
          sum += weight * cis_cycles(r / green_light + phase / (2 * pi));
          irradiance += weight / double(small.pixels());
        }
      field.samples(j, i) = sum / (2 * s);
    }
  return field;
}

struct MeanField {
  double irradiance = 0;
  FieldDouble field = make_mean_field(irradiance);
  double intensity() const { return power(field) / (double(small.pixels()) * small.pitch * small.pitch); }
};

const MeanField& mean_field() {
  static const MeanField mean;
  return mean;
}

/// U/√N of the shared strategy: rays of `seed`, surface phases of seed 1.
FieldDouble shared_estimate(int64_t samples, int64_t seed) {
  const TraceParams params{.pattern = Pattern::random,
                           .samples = samples,
                           .paths = 1,
                           .max_depth = 1,
                           .phase = SourcePhase::surface,
                           .grain = grain,
                           .one_wave_per_cell = false,
                           .seed = seed};
  Sources sources = trace(make_patch(), small, green_light, params);
  for (size_t i = 0; i < sources.waves.size(); ++i)
    sources.waves[i].phase = float(random_phase(1, 0, sources.phase_keys[i]));
  FieldDouble field = convert<double>(synthesize(sources, small, {SynthesisMethod::automatic, 5e-3}));
  for (Complex& u : field.samples.values) u /= std::sqrt(double(samples));
  return field;
}

FieldDouble gathered_estimate(int samples) {
  const TraceParams params{.pixel_samples = samples,
                           .paths = 1,
                           .max_depth = 1,
                           .phase = SourcePhase::surface,
                           .grain = grain,
                           .one_wave_per_cell = false};
  FieldDouble field = convert<double>(gather(make_patch(), small, {green_light}, params).at(0));
  for (Complex& u : field.samples.values) u /= std::sqrt(double(samples));
  return field;
}

/// Re Σ U·conj M/Σ|M|²: 1 for an unbiased estimate.
double projection(const FieldDouble& field, const FieldDouble& mean) {
  double sum = 0, energy = 0;
  for (size_t i = 0; i < mean.samples.size(); ++i) {
    sum += (field.samples.values[i] * std::conj(mean.samples.values[i])).real();
    energy += std::norm(mean.samples.values[i]);
  }
  return sum / energy;
}

// A ray contributes E|a|² = E, so the relative error is at most √((E − |M|²)/(N·|M|²)); strata lower it.
// Deterministic differences of the weights are O(θ²) = (0.4/20)² = 4e-4.
TEST(Coherence, SharedAndGatheredFieldsHaveOneMean) {
  const MeanField& mean = mean_field();
  const double variance = mean.irradiance / mean.intensity() - 1;
  // Speckles of λz/0.3 mm = 35 µm: 200 on the panel. Within a speckle the errors of a shared wave are similar.
  const FieldDouble few = shared_estimate(40000, 5), many = shared_estimate(640000, 6);
  const double expected = std::sqrt(variance / 640000);
  EXPECT_LT(relative_error(many, mean.field), 1.2 * expected);  // 200 speckles: a standard error of 1/√400; 4 of them
  EXPECT_NEAR(relative_error(few, mean.field) / relative_error(many, mean.field), 4, 4 * 0.3);
  EXPECT_NEAR(projection(many, mean.field), 1, 4 * expected / std::sqrt(2 * 200) + 1e-2);

  // The pixels of gather are independent of each other.
  const FieldDouble sparse = gathered_estimate(16), dense = gathered_estimate(256);
  const double of_dense = std::sqrt(variance / 256);
  EXPECT_LT(relative_error(dense, mean.field), 1.05 * of_dense);
  // The error falls as N^(−1/2), or faster where strata resolve the fringes.
  EXPECT_GT(relative_error(sparse, mean.field) / relative_error(dense, mean.field), 4 * 0.9);
  EXPECT_NEAR(projection(dense, mean.field), 1, 4 * of_dense / std::sqrt(2.0 * 4096) + 1e-2);
}

// closed_forms.md 16: E|Û_N|² = |M|² + Var/N; the product of two independent halves of the rays has no bias.
TEST(Coherence, IntensityIsBiasedByOneOverNAndTheCrossEstimatorIsNot) {
  const MeanField& mean = mean_field();
  const double pixels = double(small.pixels());
  const auto bias_of = [&](int64_t samples, Statistics& intensity, Statistics& variance, Statistics& cross) {
    FieldDouble last;
    for (int64_t seed = 10; seed < 34; ++seed) {
      const FieldDouble field = shared_estimate(samples, seed * 1000 + samples);
      double sum = 0, error = 0, product = 0;
      for (size_t i = 0; i < field.samples.size(); ++i) {
        const Complex u = field.samples.values[i], m = mean.field.samples.values[i];
        sum += std::norm(u) - std::norm(m);
        error += std::norm(u - m);
        if (seed % 2) product += (u * std::conj(last.samples.values[i])).real() - std::norm(m);
      }
      intensity.add(sum / pixels);
      variance.add(error / pixels);
      if (seed % 2) cross.add(product / pixels);
      last = field;
    }
  };
  Statistics intensity[2], variance[2], cross[2];
  bias_of(5000, intensity[0], variance[0], cross[0]);
  bias_of(20000, intensity[1], variance[1], cross[1]);
  for (const int i : {0, 1}) {
    // z-tests, 4 standard errors of 24 and 12 independent runs.
    EXPECT_NEAR(intensity[i].mean(), variance[i].mean(),
                4 * std::hypot(intensity[i].standard_error(), variance[i].standard_error()));
    EXPECT_NEAR(cross[i].mean(), 0, 4 * cross[i].standard_error());
  }
  EXPECT_GT(intensity[0].mean(), 4 * intensity[0].standard_error()) << "the bias is there to be seen";
  const double ratio = variance[0].mean() / variance[1].mean();
  EXPECT_NEAR(ratio, 4,
              4 * ratio *
                  std::hypot(variance[0].standard_error() / variance[0].mean(),
                             variance[1].standard_error() / variance[1].mean()));
}

// --- one wave per cell: both strategies converge to the same field -------------------------------

/// A patch of 3 × 3 whole cells of the side `grain`, whose faces lie at (n − (0.41421356, 0.73205081))·grain.
constexpr Vec3 corner{-1.41421356 * grain, -1.73205081 * grain, -wall_depth};

Scene make_cells() {
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_test_quad(corner + Vec3{1.5, 1.5, 0} * grain, {1.5 * grain, 0, 0}, {0, 1.5 * grain, 0})};
  return scene;
}

/// U(p) = Σ_c √(∫_c z²/r⁴ dA)·exp(i(k·r_c + φ_c)) over the cells, r_c from their centres: each has its irradiance.
FieldDouble make_field_of_cells(const Grid& grid) {
  constexpr int parts = 4;  // z²/r⁴ is linear over a quarter of a cell, to (25 µm/20 mm)² = 2e-6
  FieldDouble field(grid, green_light);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i)
      for (int cell = 0; cell < 9; ++cell) {
        const Vec3 low = corner + Vec3{double(cell % 3), double(cell / 3), 0} * grain;
        const Vec3 middle = low + Vec3{grain / 2, grain / 2, 0}, pixel{grid.x(i), grid.y(j), 0};
        double light = 0;
        for (int b = 0; b < parts; ++b)
          for (int a = 0; a < parts; ++a) {
            const Vec3 way = low + Vec3{a + 0.5, b + 0.5, 0} * (grain / parts) - pixel;
            light += std::pow(wall_depth / dot(way, way), 2) * std::pow(grain / parts, 2);
          }
        const double phase = random_phase(1, 0, surface_phase_key(middle, grain));
        field.samples(j, i) += std::sqrt(light) * cis_cycles(length(middle - pixel) / green_light + phase / (2 * pi));
      }
  return field;
}

TEST(Coherence, WithOneWavePerCellBothStrategiesConvergeToTheFieldOfTheCells) {
  TraceParams params{
      .pattern = Pattern::random, .paths = 1, .max_depth = 1, .phase = SourcePhase::surface, .grain = grain};
  const FieldDouble expected = make_field_of_cells(small);
  const double s = acceptance_sine(green_light, small.pitch), k = 2 * pi / green_light;
  double errors[2];
  for (const int i : {0, 1}) {
    params.samples = i ? 640000 : 40000;
    const Sources sources = trace(make_cells(), small, green_light, params);
    ASSERT_EQ(sources.waves.size(), 9u);
    errors[i] = relative_error(convert<double>(synthesize(sources, small, {SynthesisMethod::exact})), expected);
    // A cell has n hits, from its share of the étendue. The hit nearest to its centre is off by g/√(πn) rms. This
    // changes the phase by k times that distance times the slope of the path to a pixel (rms, one axis).
    const double n = double(params.samples) * grain * grain / (wall_depth * wall_depth) / (4 * s * s);
    const double slope = std::sqrt((0.512_mm * 0.512_mm + 0.3_mm * 0.3_mm) / 12) / wall_depth;
    const double of_place = k * grain / std::sqrt(pi * n) * slope, of_light = 0.5 / std::sqrt(n);
    EXPECT_LT(errors[i], 2 * std::hypot(of_place, of_light));  // nine waves: their rms varies by about a quarter
  }
  EXPECT_GT(errors[0] / errors[1], 2) << "16 times the rays, a quarter of the error";

  const Grid part{32, 32, 8e-6};
  params.pixel_samples = 2048;
  const FieldDouble gathered = convert<double>(gather(make_cells(), part, {green_light}, params).at(0));
  // The counts in a cell vary at most as in a Poisson law: √n/2 of √n.
  const double n = 2048 * grain * grain / (wall_depth * wall_depth) / (4 * s * s);
  EXPECT_LT(relative_error(gathered, make_field_of_cells(part)), 0.5 / std::sqrt(n));
}

}  // namespace
}  // namespace holotrace
