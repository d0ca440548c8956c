#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/wave/planes/plane_plan.h"
#include "holotrace/wave/shared/gridding_kernel.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/synthesize.h"
#include "support/devices.h"
#include "support/fields.h"
#include "support/panels.h"
#include "support/wavelengths.h"

// Waves by planes of fixed curvature, tile by tile, compared with the sum one by one, on the processor and on every OpenCL
// device of this machine.

namespace holotrace {
namespace {

using namespace literals;
using test::make_random_sources;
using test::relative_error;

// ∫φ(x)cos(2πξx)dx and its use on a grid: the widths' errors as the kernel's authors give them for a grid twice as
// fine, about 10^(1−w), less two digits for the narrowest.
TEST(GriddingKernel, ErrorFallsTenfoldPerCell) {
  for (int width = 3; width <= 7; ++width) {
    EXPECT_LT(gridding_error(width), 3 * std::pow(10.0, 1 - width)) << width;
    EXPECT_GT(gridding_error(width - 1), 5 * gridding_error(width)) << width;
  }
}

// The aliases of a kernel of w cells on a grid σ times as fine fall as exp(−πw·√(1 − 1/σ)) (Barnett, Magland and af Klinteberg,
// section 3): by 6.1 for each cell with σ = 1.5. Here β has the least error over all outputs, which changes that by up to 1.2 times.
TEST(GriddingKernel, ErrorFallsSixfoldPerCellOfACoarserGrid) {
  const double per_cell = std::exp(pi * std::sqrt(1 - 1 / 1.5));
  for (int width = 3; width <= 8; ++width) {
    EXPECT_GT(gridding_error(width - 1, 1.5), per_cell / 1.2 * gridding_error(width, 1.5)) << width;
    EXPECT_LT(gridding_error(width - 1, 1.5), per_cell * 1.2 * gridding_error(width, 1.5)) << width;
    EXPECT_GT(gridding_error(width, 1.5), gridding_error(width)) << width;
  }
  EXPECT_EQ(error_of([] { GriddingKernel(4, 1.25); }), "expected a grid 2 or 1.5 times as fine, got 1.25");
}

// Error of a plane wave along one axis by the kernel itself, without polynomials; over the outputs that are used.
double error_of_kernel(int width, double oversampling) {
  const GriddingKernel kernel(width, oversampling);
  constexpr int outputs = 32, fractions = 16;
  double error = 0;
  for (int i = 0; i < outputs; ++i)
    for (int j = 0; j < fractions; ++j) {
      const double xi = ((i + 0.5) / outputs - 0.5) / oversampling;
      std::complex<double> sum = 0;
      for (int l = 0; l < width; ++l) {
        const double x = (j + 0.5) / fractions - width / 2.0 + l;
        sum += kernel.value(x) * std::polar(1.0, 2 * pi * xi * x);
      }
      error += std::norm(sum / kernel.transform(xi) - 1.0);
    }
  return std::sqrt(error / (outputs * fractions));
}

// At its edge the kernel rises from 0 to e^−β at once: there the polynomials are compared with the limit from inside.
TEST(GriddingKernel, PolynomialsAreTheKernel) {
  for (const double oversampling : {2.0, 1.5})
    for (int width = 4; width <= 8; ++width) {
      const GriddingKernel kernel(width, oversampling);
      // A third of the kernel's own error in a plane wave, and a float's rounding.
      const double last = width / 2.0 * (1 - 1e-12), tolerance = 0.3 * error_of_kernel(width, oversampling) + 1e-7;
      for (int l = 0; l < width; ++l)
        for (int i = 0; i <= 50; ++i) {
          const double t = i / 50.0, x = t - width / 2.0 + l;
          EXPECT_NEAR(kernel.weight(l, t), kernel.value(std::clamp(x, -last, last)), tolerance) << width << " " << x;
        }
    }
}

// A plan for 1e-3, the default, has a margin of 25 %. Over both axes, four cells stay below it.
TEST(GriddingKernel, OfFourCellsIsAccurateEnoughForTheDefaultTolerance) {
  EXPECT_LT(std::sqrt(2.0) * gridding_error(4), 1e-3 / 1.25);
}

struct PlanesCase {
  int nx, ny, waves;
  double nearest, farthest, pitch, tolerance;
  double around = 0.4;  // of the panel's size, where waves are on all sides of it
};

Field sum_planes_on(const DeviceChoice& device, const Sources& sources, const Grid& grid, double tolerance,
                    const Observer& observer = {}) {
  SynthesizeParams params{SynthesisMethod::planes, tolerance};
  params.device = device;
  return synthesize(sources, grid, params, observer);
}

class SumPlanes : public ::testing::TestWithParam<std::tuple<PlanesCase, DeviceChoice>> {};

// Sources all over and around the panel: tiles that boxes cover, cut along one axis, cut at a corner, and miss.
TEST_P(SumPlanes, IsWithinItsTolerance) {
  const auto& [c, device] = GetParam();
  const Grid grid{c.nx, c.ny, c.pitch};
  const Sources sources = make_random_sources(c.waves, grid, green, c.nearest, c.farthest, c.around);
  Heard heard;
  const double error =
      relative_error(sum_planes_on(device, sources, grid, c.tolerance, heard.observer()), sum_exact(sources, grid));
  EXPECT_LT(error, c.tolerance);
  // The error foretold is that of some 128 of the waves' pixels, a few percent off for many waves, and of gridding at
  // its worst: a term of the expansion that is wrong shows here. One wave's error is where few of those pixels fall.
  EXPECT_LT(error, (c.waves > 1 ? 1.3 : 2) * heard.number("expected_error"));
  EXPECT_GT(error, c.tolerance / 100) << "a plan that much finer than asked for would be a waste";
}

constexpr std::array planes_cases{
    PlanesCase{300, 250, 60, 0.19, 0.21, 8e-6, 1e-2},
    PlanesCase{300, 250, 60, 0.19, 0.21, 8e-6, 1e-3},
    PlanesCase{300, 250, 60, 0.19, 0.21, 8e-6, 1e-4},
    PlanesCase{500, 131, 30, 0.15, 0.25, 8e-6, 3e-3},
    PlanesCase{131, 500, 30, 0.05, 0.5, 8e-6, 1e-3},
    PlanesCase{64, 64, 1, 0.2, 0.2, 8e-6, 1e-3},
    PlanesCase{241, 119, 40, 0.01, 0.3, 8e-6, 1e-3},  // near ones go to tiles
    PlanesCase{360, 240, 30, 0.05, 0.07, 3.74e-6, 3e-3},
    PlanesCase{300, 200, 30, 1.0, 3.0, 8e-6, 1e-4},
    PlanesCase{360, 240, 30, 0.19, 0.21, 8e-6, 1e-5},
    PlanesCase{500, 500, 100, 1.0, 1.05, 8e-6, 1e-5, 7.75}};  // ±33 mm, all of the acceptance

std::string case_and_device(const ::testing::TestParamInfo<std::tuple<PlanesCase, DeviceChoice>>& info) {
  const auto& [c, device] = info.param;
  return fmt::format("{}x{}_{}_waves_{:.0f}_to_{:.0f}_mm_{:.0f}_ppm_{}", c.nx, c.ny, c.waves, 1e3 * c.nearest,
                     1e3 * c.farthest, 1e6 * c.tolerance, test::device_name(device));
}

INSTANTIATE_TEST_SUITE_P(Jobs, SumPlanes,
                         ::testing::Combine(::testing::ValuesIn(planes_cases),
                                            ::testing::ValuesIn(test::processor_and_devices())),
                         case_and_device);

class SumPlanesBox : public ::testing::TestWithParam<DeviceChoice> {
 protected:
  static Field sum_planes(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer = {}) {
    return sum_planes_on(GetParam(), sources, grid, tolerance, observer);
  }
};

INSTANTIATE_TEST_SUITE_P(On, SumPlanesBox, ::testing::ValuesIn(test::processor_and_devices()), test::device_name_of);

// Planes of a slab are interpolated, and must hold between them the curvatures of all light in the waves' boxes: along
// y that is ∂²r/∂y²/λ = (1 − y²/r²)/λr, from 1/λd on the axis to the least at the corner of the box of the farthest
// wave.
TEST(PlaneSlabs, HoldTheCurvaturesOfAllLightInTheirBoxes) {
  const WaveDepths depths{0.15_m, 0.3_m};
  for (const double pitch : {8_um, 3.74_um}) {
    const double tangent = acceptance_tangent(green, pitch);
    for (const int count : {1, 4}) {
      const Slabs slabs{depths, count};
      for (int i = 0; i <= 60; ++i) {
        const double d = depths.nearest + i / 60.0 * (depths.farthest - depths.nearest);
        const Slab slab = slabs.slab(slabs.of(d), green, pitch);
        const double room = 1e-9 * slab.centre;  // rounding at the border of two slabs
        for (int a = 0; a <= 10; ++a)
          for (int b = 0; b <= 10; ++b) {
            const double x = a / 10.0 * d * tangent, y = b / 10.0 * d * tangent, r = std::sqrt(x * x + y * y + d * d);
            const double curvature = (1 - y * y / (r * r)) / (green * r);
            EXPECT_LE(std::abs(curvature - slab.centre), slab.half + room) << d << " " << x << " " << y;
          }
      }
      // No wider than light half a tile (a quarter of the box at most) beyond the boxes would need: planes cost time.
      const Slab all = Slabs{depths, 1}.slab(0, green, pitch);
      const double t2 = 1.25 * 1.25 * tangent * tangent, r = depths.farthest * std::sqrt(1 + 2 * t2);
      EXPECT_LE(2 * all.half, 1 / (green * depths.nearest) - (1 - t2 / (1 + 2 * t2)) / (green * r));
    }
  }
}

// A wave whose box ends inside the panel on every side, by the four kinds of tiles: the sharp edge is exact's own.
TEST_P(SumPlanesBox, EndsWhereTheBoxOfExactEnds) {
  const Grid grid{640, 600, 8_um};
  const Sources sources{green, {{{0.313_mm, -0.207_mm, -60_mm}, 1, 0.7F}}};  // a box of 499 pixels
  const Field planes = sum_planes(sources, grid, 1e-3);
  const FieldDouble exact = sum_exact(sources, grid);
  int64_t dark = 0;
  double worst = 0;
  for (int64_t i = 0; i < grid.pixels(); ++i)
    if (exact.samples.values[size_t(i)] == 0.0) {
      ++dark;
      worst = std::max(worst, double(std::abs(planes.samples.values[size_t(i)])));
    }
  ASSERT_GT(dark, grid.pixels() / 4);
  EXPECT_LT(worst, 4e-3) << "a wave taken away by strips leaves its error, 4 times the rms that the tolerance is of";
  EXPECT_LT(relative_error(planes, exact), 1e-3);
}

// The right and the lower edge of this box leave more than half of their tiles lit, of any size of tiles.
TEST_P(SumPlanesBox, EndsWhereMostOfATileIsLit) {
  const Grid grid{640, 600, 8_um};
  const Sources sources{green, {{{0.124_mm, 0.192_mm, -60_mm}, 1, 0.7F}}};
  EXPECT_LT(relative_error(sum_planes(sources, grid, 1e-3), sum_exact(sources, grid)), 1e-3);
}

// Every tile of a narrow panel is cut by boxes' edges: strips make them up, or take away what a wave lights too much,
// which leaves errors where it is dark. The plan has to count them, and the coarse one shows it (1.5 of what it was
// said to be, and 1.28e-3 at 1e-3, where only lit pixels were counted).
TEST_P(SumPlanesBox, ErrorOfStripsIsForetold) {
  const Grid grid{60, 300, 8_um};
  Sources sources = make_random_sources(60, {40, 300, 8_um}, green, 0.19_m, 0.21_m);
  for (Source& wave : sources.waves) wave.origin.x += -wave.origin.z * acceptance_tangent(green, grid.pitch);
  const FieldDouble exact = sum_exact(sources, grid);
  for (const double tolerance : {1e-2, 1e-3}) {
    Heard heard;
    const double error = relative_error(sum_planes(sources, grid, tolerance, heard.observer()), exact);
    EXPECT_LT(error, tolerance);
    if (tolerance == 1e-2) {
      EXPECT_LT(error, 1.3 * heard.number("expected_error"));
    }
  }
}

TEST_P(SumPlanesBox, CoincidentWavesAreOneOfTheirSum) {
  const Grid grid{256, 200, 8_um};
  const Source one{{0.2_mm, 0.1_mm, -0.2_m}, 1, 0.3F}, three{{0.2_mm, 0.1_mm, -0.2_m}, 3, 0.3F};
  const Field thrice = sum_planes({green, {one, one, one}}, grid, 1e-4),
              once = sum_planes({green, {three}}, grid, 1e-4);
  EXPECT_LT(relative_error(convert<double>(thrice), convert<double>(once)), 1e-6);  // rounding of three sums
}

// The sum is linear in the amplitudes by the same plan: floats keep 24 bits.
TEST_P(SumPlanesBox, IsLinear) {
  const Grid grid{256, 200, 8_um};
  Sources all = make_random_sources(40, grid, green, 0.19_m, 0.21_m), even = all, odd = all;
  for (size_t i = 0; i < all.waves.size(); ++i) (i % 2 ? even : odd).waves[i].amplitude = 0;
  Field sum = sum_planes(even, grid, 1e-3);
  const Field other = sum_planes(odd, grid, 1e-3);
  for (size_t i = 0; i < sum.samples.size(); ++i) sum.samples.values[i] += other.samples.values[i];
  EXPECT_LT(relative_error(sum, convert<double>(sum_planes(all, grid, 1e-3))), 1.5e-3);  // plans may differ
}

TEST_P(SumPlanesBox, BytesDoNotDependOnThreads) {
  const Grid grid{400, 300, 8_um};
  const Sources sources = make_random_sources(200, grid, green, 0.19_m, 0.21_m, 0.2);
  std::vector<Field> fields;
  for (const int threads : {1, 2, 5}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, size_t(threads));
    fields.push_back(sum_planes(sources, grid, 1e-3));
  }
  EXPECT_EQ(fields[0].samples.values, fields[1].samples.values);
  EXPECT_EQ(fields[0].samples.values, fields[2].samples.values);
}

TEST_P(SumPlanesBox, KeepsItsToleranceForWavesThatCancel) {
  const Grid grid{512, 384, 8_um};
  const Sources sources{green,
                        {{{1_mm, 0.5_mm, -0.2_m}, 1, 0},
                         {{1_mm, 0.5_mm, -0.2_m - 1_um}, 1, float(pi - 2 * pi * std::fmod(1_um / green, 1.0))}}};
  const FieldDouble exact = sum_exact(sources, grid);
  ASSERT_LT(power(exact), 0.01 * double(grid.pixels()) * 64e-12);
  EXPECT_LT(relative_error(sum_planes(sources, grid, 2e-2), exact), 2e-2);
}

// Pairs in antiphase, half a cell apart: the field has a sixth of its waves' energy, which the plan has to find out.
TEST_P(SumPlanesBox, KnowHowMuchTheirWavesCancel) {
  const Grid grid{60, 60, 8_um};
  Sources sources{green, {}};
  const Sources random = make_random_sources(200, grid, green, 0.2_m, 0.2_m);
  for (const Source& s : random.waves) {
    Source other = s;
    other.origin.x += green * 0.2_m / (4 * grid.width());
    other.phase += float(pi);
    sources.waves.push_back(s);
    sources.waves.push_back(other);
  }
  const auto waves = prepare_waves(sources, grid);
  const PixelBox all{0, grid.nx, 0, grid.ny};
  const TileChoice tiles = choose_tile(waves, grid, green, 1e-3);
  const PlanesChoice planes =
      choose_planes(waves, draw_pixels(waves), planes_cost_on_processor(tiles.plan), {grid, all, green, 1e-3});
  EXPECT_NEAR(planes.energies.waves / tiles.energies.waves, 1, 0.1);  // an eighth of the draws, 1,024 of them
  const FieldDouble exact = sum_exact(sources, grid);
  for (const double tolerance : {1.5e-4, 1.2e-4})
    EXPECT_LT(relative_error(sum_planes(sources, grid, tolerance), exact), tolerance);
}

// Of waves as far as these, r₀ and the depth differ in the last of a double's digits.
TEST(SumPlanesOfFarWaves, KeepsTheirPhase) {
  const Grid grid{200, 150, 8_um};
  Sources sources{green, {}};
  for (const double x : {-1e5, 0.0, 3e4, 1e5}) sources.waves.push_back({{x, 0.3 * x, -1e8}, 1, 0.4F});
  EXPECT_LT(relative_error(sum_planes_on(DeviceChoice(), sources, grid, 1e-4), sum_exact(sources, grid)), 1e-4);
}

// Many waves: auto takes planes, and their error is that of some of the pixels.
TEST(SumPlanesOfManyWaves, AreWhatAutoTakes) {
  const Grid grid{600, 400, 8_um};
  const Sources sources = make_random_sources(100000, grid, green, 0.19_m, 0.21_m);
  std::string method;
  const Observer observer{nullptr,
                          [&](const std::string& name, const Fact& fact) {
                            if (name == "method") method = std::get<std::string>(fact);
                          },
                          nullptr};
  const Field field = synthesize(sources, grid, {SynthesisMethod::automatic, 3e-3}, observer);
  EXPECT_EQ(method, "planes");
  EXPECT_LT(sampled_error(field, sources, 50), 4.2e-3);  // 50 pixels tell the error to about 1/√(2·50), 4 σ: 40 %
}

TEST_P(SumPlanesBox, RefusesAToleranceThatFloatsCannotHold) {
  const Grid grid{64, 64, 8_um};
  try {
    sum_planes(make_random_sources(3, grid, green, 0.2_m, 0.2_m), grid, 1e-7);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("tolerance that planes can meet"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace holotrace
