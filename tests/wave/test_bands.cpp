#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/random.h"
#include "holotrace/data/grid.h"
#include "holotrace/wave/bands.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/synthesize.h"
#include "support/fields.h"
#include "support/panels.h"

namespace holotrace {
namespace {

constexpr Grid bands_panel{96, 400, 8e-6};

// Waves with random phases above and around the panel, near enough that their boxes end on it.
Sources make_waves(int count, uint64_t seed = 1) {
  CounterRandom random(seed, 0, 0);
  Sources sources{.wavelength = 532e-9};
  for (int i = 0; i < count; ++i)
    sources.waves.push_back(
        {{(random.uniform() - 0.5) * 2e-3, (random.uniform() - 0.5) * 4e-3, -0.015 - 0.02 * random.uniform()},
         1,
         float(2 * pi * random.uniform())});
  return sources;
}

// Gives the waves a separate amplitude in each of columns × rows tiles; some are 0.
void give_tiles(Sources& sources, int columns, int rows) {
  CounterRandom random(9, 0, 0);
  sources.tiles = {columns, rows, {}};
  for (size_t i = 0; i < sources.waves.size() * size_t(columns * rows); ++i)
    sources.tiles.values.push_back(random.uniform() < 0.3 ? 0.0f : float(random.uniform()));
}

// Relative L2 difference between a field made in bands and one made as a whole.
double difference(const Sources& sources, const Grid& grid, const SynthesizeParams& params,
                  const std::vector<Band>& bands, const FieldDouble& whole) {
  double error = 0, sum = 0;
  for (const Band& band : bands) {
    const Field field = synthesize_band(sources, grid, band, params);
    EXPECT_EQ(field.samples.ny, band.rows());
    for (int j = 0; j < band.rows(); ++j)
      for (int i = 0; i < grid.nx; ++i) {
        const std::complex<double> u = whole.samples(band.first_row + j, i);
        error += std::norm(std::complex<double>(field.samples(j, i)) - u);
        sum += std::norm(u);
      }
  }
  return std::sqrt(error / sum);
}

SynthesizeParams params_of(SynthesisMethod method, double tolerance = 1e-3) {
  SynthesizeParams params;
  params.method = method;
  params.tolerance = tolerance;
  return params;
}

TEST(Bands, CoverEveryRowOfEverySetOnceInMultiplesOf128) {
  const std::vector<Sources> sets{make_waves(3), make_waves(5)};
  for (const int rows : {1, 127, 128, 129, 1080, 20000}) {
    const std::vector<Band> bands = plan_bands(sets, {50, rows, 8e-6}, {}, 1e9);
    int set = 0, row = 0;
    for (const Band& band : bands) {
      if (row == rows) {
        ++set;
        row = 0;
      }
      EXPECT_EQ(band.set, set);
      EXPECT_EQ(band.first_row, row);
      EXPECT_TRUE(band.rows() % 128 == 0 || band.end_row == rows) << band.rows();
      row = band.end_row;
    }
    EXPECT_EQ(set, 1);
    EXPECT_EQ(row, rows);
  }
  EXPECT_EQ(plan_bands(sets, {50, 32768, 1e-6}, {}, 1e9).size(), 2u * 64);
}

TEST(Bands, FitTheMemoryOrSayWhatIsNeeded) {
  const std::vector<Sources> sets{make_waves(100)};
  const Grid large{100000, 100000, 1e-6};  // 128 rows are 102 MB, the program 50 MB
  using enum SynthesisMethod;
  for (const SynthesisMethod method : {automatic, tiled, planes, exact}) {
    const SynthesizeParams params = params_of(method);
    for (const double memory : {8e8, 2e9, 1e10})
      for (const Band& band : plan_bands(sets, large, params, memory))
        EXPECT_LE(band_memory(sets, large, params, band.rows()), memory);
    EXPECT_GT(plan_bands(sets, large, params, 4e9).front().rows(), plan_bands(sets, large, params, 8e8).front().rows());
  }
  const std::string error = error_of([&] { plan_bands(sets, large, params_of(tiled), 1.5e8); });
  EXPECT_EQ(error.find("expected --memory of "), 0u) << error;
  EXPECT_NE(error.find("for 128 rows of 100000 pixels and the waves, got 143 MiB"), std::string::npos) << error;
}

TEST(Bands, CountWavesFromInFrontOfThePanel) {
  Sources sources{.wavelength = 532e-9};
  sources.waves = {{{0, 0, 0.05}, 1, 0}, {{0, 0, -0.05}, 1, 0}, {{0.5, 0, 0.05}, 1, 0}};
  EXPECT_EQ(missed_waves(sources, bands_panel), 1);
}

TEST(Bands, LieWhereTheirRowsLie) {
  const Grid band = band_of(bands_panel, 128, 300);
  // The centre is rounded once more: 1e-18 m for 3 mm.
  for (const int row : {0, 5, 171}) EXPECT_NEAR(band.y(row), bands_panel.y(128 + row), 1e-17);
  EXPECT_EQ(band.x(7), bands_panel.x(7));
}

TEST(Bands, OfExactAreTheRowsOfTheWholeToRounding) {
  const Sources sources = make_waves(40);
  const std::vector<Band> bands = plan_bands({sources}, bands_panel, {}, 1e9);
  ASSERT_EQ(bands.size(), 4u);
  // Samples are rounded to float once: 6e-8 of each sample.
  EXPECT_LT(difference(sources, bands_panel, params_of(SynthesisMethod::exact), bands, sum_exact(sources, bands_panel)),
            6e-8);
}

TEST(Bands, OfTiledAndAutoHoldTheTolerance) {
  const Sources sources = make_waves(200);
  const FieldDouble whole = sum_exact(sources, bands_panel);
  const std::vector<Band> bands = plan_bands({sources}, bands_panel, {}, 1e9);
  for (const double tolerance : {1e-2, 1e-3})  // not 1e-4: it would need tiles smaller than any here
    EXPECT_LT(difference(sources, bands_panel, params_of(SynthesisMethod::tiled, tolerance), bands, whole), tolerance);
  // 1e-6 is below the rounding of single precision: auto sums these bands wave by wave.
  EXPECT_LT(difference(sources, bands_panel, params_of(SynthesisMethod::automatic, 1e-6), bands, whole), 1e-6);
  for (const double tolerance : {1e-2, 1e-3, 1e-4})
    EXPECT_LT(difference(sources, bands_panel, params_of(SynthesisMethod::automatic, tolerance), bands, whole),
              tolerance);
}

TEST(Bands, KeepTheAmplitudesOfThePanelsTiles) {
  Sources sources = make_waves(60);
  give_tiles(sources, 3, 7);  // 400 rows of pixels in 7 rows of tiles: none ends at a multiple of 128
  const std::vector<Band> bands = plan_bands({sources}, bands_panel, {}, 1e9);
  for (const Band& band : bands)
    for (int tile = 1; tile < 7; ++tile) {
      const int start = tile_start(tile, 7, bands_panel.ny);
      EXPECT_TRUE(start <= band.first_row || start >= band.end_row) << "a band in two rows of tiles";
    }
  EXPECT_LT(difference(sources, bands_panel, params_of(SynthesisMethod::exact), bands, sum_exact(sources, bands_panel)),
            6e-8);
}

TEST(Bands, WithoutLightAreDark) {
  // The wave's box ends 15 mm·tan(1.9°) = 0.5 mm from the axis, in the first band.
  Sources sources{.wavelength = 532e-9, .waves = {{{0, 1.5e-3, -0.015}, 1, 0}}};
  for (const SynthesisMethod method : {SynthesisMethod::tiled, SynthesisMethod::automatic, SynthesisMethod::exact}) {
    EXPECT_GT(power(synthesize_band(sources, bands_panel, {0, 0, 128}, params_of(method))), 0);
    EXPECT_EQ(power(synthesize_band(sources, bands_panel, {0, 256, 384}, params_of(method))), 0);
  }
  EXPECT_EQ(missed_waves(sources, bands_panel), 0);
  sources.waves[0].origin.y = 1;
  EXPECT_EQ(missed_waves(sources, bands_panel), 1);
}

TEST(Bands, ShareTheWorkAsTheirWavesDo) {
  const std::vector<Sources> sets{make_waves(4000), make_waves(1)};
  const std::vector<Band> bands = plan_bands(sets, bands_panel, {}, 1e9);
  const std::vector<double> shares = band_shares(sets, bands_panel, bands);
  double sum = 0, work_of_all = 0;
  for (const Sources& set : sets)
    work_of_all += double(waves_pixels(set, bands_panel)) + 300.0 * double(bands_panel.pixels());
  for (size_t i = 0; i < bands.size(); ++i) {
    const Grid grid = band_of(bands_panel, bands[i].first_row, bands[i].end_row);
    const double work = double(waves_pixels(sets[size_t(bands[i].set)], grid)) + 300.0 * double(grid.pixels());
    EXPECT_NEAR(shares[i], work / work_of_all, 1e-12) << "rounding of sums below 1e10";
    sum += shares[i];
  }
  EXPECT_NEAR(sum, 1, 1e-12);
}

TEST(Bands, AreOfMethodsThatSumWaves) {
  const Sources sources = make_waves(1);
  EXPECT_EQ(error_of([&] {
              synthesize_band(sources, bands_panel, {0, 0, 128}, params_of(SynthesisMethod::layers));
            }),
            "expected the method auto, exact, tiled or planes for a field made in bands, got layers; choose one of "
            "them, or make the field whole, without --memory and without mpirun");
}

// All colours of a job share the cone of the shortest wavelength, which lights fewer pixels than the waves' own.
TEST(Bands, KeepTheConeOfTheColours) {
  Sources sources = make_waves(40);
  const FieldDouble own = sum_exact(sources, bands_panel);
  sources.label.cone_wavelength = 450e-9;
  const FieldDouble whole = sum_exact(sources, bands_panel);
  ASSERT_GT(test::relative_error(own, whole), 0.1);
  const SynthesizeParams params = params_of(SynthesisMethod::exact);
  // Sums in double, rounded to single precision.
  EXPECT_LT(difference(sources, bands_panel, params, plan_bands({sources}, bands_panel, params, 1e9), whole), 1e-7);
}

}  // namespace
}  // namespace holotrace
