// Waves by planes of fixed curvature on every OpenCL device of this machine; scripts/setup installs PoCL, so there is one.
// test_planes.cpp compares them with the exact sum.

#include <gtest/gtest.h>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/planes/device_planes.h"
#include "holotrace/wave/planes/plane_plan.h"
#include "holotrace/wave/shared/stage_on_device.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/summation.h"
#include "holotrace/wave/synthesize.h"
#include "holotrace/wave/tiles/device_tiles.h"
#include "support/build_paths.h"
#include "support/fields.h"
#include "support/panels.h"
#include "support/stages_on_devices.h"
#include "support/wavelengths.h"
#if HOLOTRACE_HAS_OPENCL
#include "support/faulty_api.h"
#endif

namespace holotrace {
namespace {

using namespace literals;
using test::make_random_sources;
using test::relative_error;

class DevicePlanesTest : public test::StagesOnDevices {};

HOLOTRACE_FOR_ALL_DEVICES(DevicePlanesTest);

// 201 x 131 pixels: the last tiles of both axes are cut by the panel's edges. At 52 mm, boxes of 216 pixels on either side
// cover the panel, so that all light is that of planes.
constexpr Grid panel{201, 131, 8e-6};
constexpr PixelBox whole_panel{0, panel.nx, 0, panel.ny};

Sources drawn_sources(int count, double nearest = 0.19_m, double farthest = 0.21_m) {
  return make_random_sources(count, panel, green, nearest, farthest);
}

std::vector<PlanesPlan> drawn_plans() {
  return {{60, 4, 2, 1, false, false},
          {60, 6, 3, 2, true, false},
          {120, 7, 4, 4, true, false},
          {240, 5, 3, 1, true, false}};
}

struct PlanesJob {
  PlanesTables tables;
  SortedWaves waves;

  PlanesJob(const Sources& sources, const PlanesPlan& plan)
      : tables(plan, green, panel.pitch), waves(sort_waves(prepare_waves(sources, panel), plan, green, panel.pitch)) {}
};

Field sum_on(Device& device, const Sources& sources, const PlanesPlan& plan) {
  const PlanesJob job(sources, plan);
  Field field(panel, green);
  const PacketedWaves packeted(job.waves, job.tables, panel, whole_panel);
  DevicePlanes planes(device, packeted, job.tables);
  const auto make = [&](Device&) {
    return LightOnDevice{[&](const auto&... band) { planes.add(band...); }, planes.least_memory()};
  };
  sum_tiles_on_device(device, {}, {panel, green}, {32, 32}, whole_panel, field.samples, {}, {make, plan.tile});
  return field;
}

Field sum_on_processor(const Sources& sources, const PlanesPlan& plan) {
  const PlanesJob job(sources, plan);
  Field field(panel, green);
  PlanesWorkspace workspace;
  const TilePlan direct{{32, 2}};
  for (int y = 0; y < panel.ny; y += plan.tile)
    for (int x = 0; x < panel.nx; x += plan.tile)
      sum_planes_tile({job.waves, job.tables, direct, panel},
                      {x, std::min(x + plan.tile, panel.nx), y, std::min(y + plan.tile, panel.ny)}, workspace,
                      field.samples);
  return field;
}

// A wave in a tile as docs/explanation/mathematics.md gives it, in double: f = x/λr₀·(1 − c·h²/2r₀²), κ = (1 − ρ²/2r₀²)/λr₀,
// and exp(2πi·r₀/λ)·d/r₀. Frequencies are up to 120 cells, whose float has an ulp of 8e-6; a few roundings make 2e-5.
// Curvatures keep 1e-6 of 1/λd; phases keep 4e-6 of a cycle beside those of a wave at depth d.
TEST(PlaneWaves, InCppAreTheWavesOf1e5RandomPlaces) {
  CounterRandom random(4, 0, 0);
  const PlanesTables tables({120, 5, 3, 1, true, false}, green, 8_um);
  const double cells_per_frequency = 2 * 120 * 8_um, half_side = 60 * 8_um;
  double worst_cell = 0, worst_curvature = 0, worst_value = 0;
  for (int i = 0; i < 100000; ++i) {
    const double d = 0.02_m * std::pow(500, random.uniform());  // 20 mm to 10 m
    const auto within = [&](double most) { return (2 * random.uniform() - 1) * most; };
    const Source source{{within(0.1_m), within(0.1_m), -d}, 1, float(within(pi))};
    const double dx = within(0.0333 * d), dy = within(0.0333 * d);
    const PreparedWave wave = prepare_wave(source, {1, 1, 8_um}, green);
    const auto seen =
        tile_factor_kernel::wave_from_tile(device_wave(wave, green, {}), float_pair((source.origin.x + dx) / green),
                                           float_pair((source.origin.y + dy) / green));
    const Slab slab{0, 1, 1 / (green * d), 1e-3 / (green * d)};
    const auto plane = tile_factor_kernel::plane_wave(seen, slab_on_device(slab, tables));
    const double rho2 = dx * dx + dy * dy, r2 = rho2 + d * d, r0 = std::sqrt(r2);
    const double per_r0 = (1 - (3 / 5.0 + 1 / 3.0) * half_side * half_side / (2 * r2)) / (green * r0);
    worst_cell = std::max({worst_cell, std::abs(plane.x - dx * per_r0 * cells_per_frequency),
                           std::abs(plane.y + dy * per_r0 * cells_per_frequency)});  // y down
    const double kappa = (1 - rho2 / (2 * r2)) / (green * r0);
    worst_curvature = std::max(worst_curvature, std::abs(plane.tau * slab.half + slab.centre - kappa) / slab.centre);
    const std::complex<double> value = wave_at(wave, source.origin.x + dx, source.origin.y + dy, green);
    worst_value = std::max(worst_value, std::abs(std::complex<double>(plane.value.re, plane.value.im) - value));
  }
  EXPECT_LT(worst_cell, 4e-5);
  EXPECT_LT(worst_curvature, 1e-6);
  EXPECT_LT(worst_value, 2e-5);
}

// Only rounding differs: frequencies of up to 120 cells in floats (4e-6 of a cell, 6e-6 of a cycle at a tile's edge), and
// sums of 300 waves. Near waves have large corrections.
TEST_P(DevicePlanesTest, AreThoseOfTheProcessorByTheSamePlan) {
  for (const auto& [nearest, farthest] : {std::pair(0.19_m, 0.21_m), std::pair(52_mm, 55_mm)}) {
    const Sources sources = drawn_sources(300, nearest, farthest);
    for (const PlanesPlan& plan : drawn_plans())
      EXPECT_LT(relative_error(sum_on(device_, sources, plan), sum_on_processor(sources, plan)), 1e-5)
          << nearest << " m, " << plan.tile;
  }
}

// Packets of 64 waves, of which a slab has a part: counts around the borders, and none of the waves is lost or doubled.
TEST_P(DevicePlanesTest, SumPacketsOfAnyNumberOfWaves) {
  for (const int count : {1, 63, 64, 65, 129}) {
    const Sources sources = drawn_sources(count);
    const PlanesPlan plan{60, 6, 4, 2, true, false};
    EXPECT_LT(relative_error(sum_on(device_, sources, plan), sum_exact(sources, panel)), 3e-4) << count;
  }
}

// Tiles that a wave lights wholly, and the boxes that append_rest leaves, cover its box once. Nothing is shared with the code
// but the box: pixels are counted.
TEST(WholeTiles, AndTheRestCoverTheBoxOnce) {
  CounterRandom random(5, 0, 0);
  const Grid grid{310, 260, 8e-6};
  const PixelBox bounds{10, 310, 5, 245};
  int with_tiles = 0;
  for (int i = 0; i < 300; ++i) {
    const double d = 10_mm * std::pow(30, random.uniform());
    const auto within = [&](double most) { return (2 * random.uniform() - 1) * most; };
    PreparedWave wave = prepare_wave({{within(2_mm), within(2_mm), -d}, 1, 0}, grid, green);
    wave.box = intersect(wave.box, bounds);
    if (wave.box.is_empty()) continue;
    const PlaneTiles tiles{grid, bounds, 60, 1.005 * acceptance_tangent(green, grid.pitch)};
    std::vector<int> covered(size_t(grid.pixels()), 0);
    const auto cover = [&](const PixelBox& box) {
      for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x) ++covered[size_t(y * grid.nx + x)];
    };
    const PixelBox whole = whole_tiles(wave, tiles);
    with_tiles += !whole.is_empty();
    for (int v = whole.y0; v < whole.y1; ++v)
      for (int u = whole.x0; u < whole.x1; ++u) {
        const PixelBox tile{10 + 60 * u, std::min(70 + 60 * u, 310), 5 + 60 * v, std::min(65 + 60 * v, 245)};
        cover(tile);
        EXPECT_LE(std::abs(grid.x(tile.x0 + 30) - wave.x), tiles.tangent * d);
        EXPECT_LE(std::abs(grid.y(tile.y0 + 30) - wave.y), tiles.tangent * d);
      }
    std::vector<PreparedWave> rest;
    append_rest({&wave, 1}, tiles, rest);
    EXPECT_LE(rest.size(), 4u);
    for (const PreparedWave& part : rest) cover(part.box);
    for (int y = 0; y < grid.ny; ++y)
      for (int x = 0; x < grid.nx; ++x)
        ASSERT_EQ(covered[size_t(y * grid.nx + x)],
                  x >= wave.box.x0 && x < wave.box.x1 && y >= wave.box.y0 && y < wave.box.y1)
            << x << " " << y;
  }
  EXPECT_GT(with_tiles, 50);
}

TEST_P(DevicePlanesTest, SendTheWavesFetchTheSamplesAndNothingElse) {
  const PlanesPlan plan{60, 5, 3, 2, true, false};
  const Sources sources = drawn_sources(1000);
  const PlanesJob job(sources, plan);
  size_t packets = 0;
  for (const Slab& slab : job.waves.slabs) packets += (slab.last - slab.first + 63) / 64;
  const DeviceUse before = device_.use();
  sum_on(device_, sources, plan);
  const DeviceUse after = device_.use();
  // 48 bytes per wave and packet of 64; tables: places of 4 x 3 tiles (8 bytes each) and of 7 x 5 tiles of 32 x 32, 12 x 8
  // coefficients, moments of 60 pixels, 3 factors of 136 cells, chirps and corrections of 2 x 3 nodes, roots of 120 samples.
  const size_t tables = 8 * (4 + 3 + 7 + 5) + 4 * 96 + 8 * 60 + 8 * 3 * 136 + 6 * (8 * 60 + 16) + 8 * 120;
  EXPECT_EQ(after.bytes_in - before.bytes_in, 48 * (1000 + packets) + tables);
  EXPECT_EQ(after.bytes_out - before.bytes_out, 8u * size_t(panel.pixels()));
  EXPECT_EQ(after.bytes_held, before.bytes_held);
}

// 12,000 waves take 576 kB, and two or three parts where a third of 80 % of the memory is less. A tile of 60 pixels at 2 nodes
// takes 615 kB. The field takes 211 kB, and is cut into bands where that does not fit beside a tile and a part.
TEST_P(DevicePlanesTest, GiveTheSameBytesInAnyMemory) {
  const PlanesPlan plan{60, 5, 2, 2, false, false};
  const Sources sources = drawn_sources(12000);
  const Field whole = sum_on(device_, sources, plan);
  EXPECT_EQ(sum_on(device_, sources, plan).samples.values, whole.samples.values);
  for (const double memory : {4e6, 1.7e6}) {
    const DeviceUse before = device_.use();
    device_.limit_memory(memory);
    EXPECT_EQ(sum_on(device_, sources, plan).samples.values, whole.samples.values) << memory;
    const size_t sent = device_.use().bytes_in - before.bytes_in;
    EXPECT_EQ(sent > 2 * 48 * sources.waves.size(), memory < 3e6) << "sent for some tiles";
  }
  device_.limit_memory(1e6);
  EXPECT_THROW(sum_on(device_, sources, plan), Error);
  device_.limit_memory(0);
}

TEST_P(DevicePlanesTest, WriteNothingPastTheirBuffers) {
  const size_t before = device_.broken_guards();
  device_.guard_buffers(true);
  const Sources sources = drawn_sources(100);
  for (const PlanesPlan& plan : drawn_plans()) sum_on(device_, sources, plan);
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
}

// Parts of the panel with amplitudes of their own: each part has tiles of its own, and only its pixels are computed.
TEST_P(DevicePlanesTest, SumWavesWithAmplitudesInTilesOfThePanel) {
  const Grid grid{300, 250, 8_um};
  Sources sources = make_random_sources(60, grid, green, 0.19_m, 0.21_m, 0.4);
  sources.tiles = {3, 2, {}};
  for (size_t i = 0; i < 6 * sources.waves.size(); ++i) sources.tiles.values.push_back(float((i * 7 % 11) / 10.0));
  SynthesizeParams params = on_device(SynthesizeParams{SynthesisMethod::planes, 1e-3});
  EXPECT_LT(relative_error(synthesize(sources, grid, params), sum_exact(sources, grid)), 1e-3);
}

// `auto` on a device compares both methods by its rates. 3000 waves on 300 x 250 pixels are 2.2e8 waves·pixels of 4
// multiply-adds: a second by tiles at 1e9 multiply-adds per second. By planes they are 20 tiles' pairs of some 5e3 operations.
TEST_P(DevicePlanesTest, AreWhatAutoTakesIfTheDevicesRatesSaySo) {
  const Grid grid{300, 250, 8_um};
  const Sources sources = make_random_sources(3000, grid, green, 0.19_m, 0.21_m);
  const auto method_with = [&](const DeviceRates& rates) {
    set_device_rates([rates](Device&) { return rates; });
    return forecast_sum(sources, grid, 1e-2, {Approach::cheapest, &device_}).method;
  };
  EXPECT_EQ(method_with({1e9, 1e10, 1e11}), "planes");
  EXPECT_EQ(method_with({1e9, 1e10, 1e6}), "tiled") << "transforms of megabytes at a megabyte per second";
  EXPECT_EQ(method_with({1e12, 1e10, 1e11}), "tiled") << "a sum of milliseconds is not worth the time of planning";
  EXPECT_EQ(method_with({}), "tiled") << "not measured";
}

TEST_P(DevicePlanesTest, SayHowTheySum) {
  const Grid grid{300, 250, 8_um};
  const Sources sources = make_random_sources(30, grid, green, 0.19_m, 0.21_m);
  Heard heard;
  synthesize(sources, grid, on_device(SynthesizeParams{SynthesisMethod::planes, 1e-2}), heard.observer());
  EXPECT_EQ(std::get<std::string>(heard.facts.at("method")), "planes");
  const std::string how = std::get<std::string>(heard.facts.at("how"));
  EXPECT_NE(how.find(device_.info().name), std::string::npos) << how;
}

TEST_P(DevicePlanesTest, ReportProgressUpToTheWhole) {
  std::vector<double> fractions;
  Observer observer;
  observer.on_progress = [&](double fraction) { fractions.push_back(fraction); };
  const Grid grid{300, 250, 8_um};
  synthesize(make_random_sources(60, grid, green, 0.19_m, 0.21_m, 0.4), grid,
             on_device(SynthesizeParams{SynthesisMethod::planes, 1e-2}), observer);
  ASSERT_GE(fractions.size(), 2u);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_NEAR(fractions.back(), 1, 1e-12);
}

#if HOLOTRACE_HAS_OPENCL

// Every call that may fail fails once: the sum then ends with a sentence, and its memory is released.
TEST_P(DevicePlanesTest, ReleaseTheirMemoryWhereverTheyFail) {
  const Sources sources = drawn_sources(20);
  const PlanesPlan plan{240, 4, 2, 1, true, false};
  sum_on(device_, sources, plan);
  EXPECT_GT(test::fail_every(1, [&] { sum_on(device_, sources, plan); }), 20);
}

#endif

// Rows of blocks that all devices compute, counted row by row: a block that two shares light counts for both.
int counted_rows(int rows, int share, int block) {
  int most = 0;
  for (int first = 0; first < rows; first += share) {
    int computed = 0;
    for (int row = 0; row < rows; ++row)
      computed += row / block * block < std::min(first + share, rows) && row / block * block + block > first;
    most = std::max(most, computed);
  }
  return most;
}

// 1,080 rows in blocks of 120. Halves by tiles of 4 rows meet at 540, inside a block: 600 rows of blocks each, as many as one
// device would have of shares of 600. Of fifths, 216 rows, some reach into three blocks, 360 rows: two whole blocks are less.
// By tiles of 32 rows the least common multiple is 480, and 960 rows would be more work than 600. No device is left idle.
TEST(RowsOfDevices, AreWholeBlocksWhereThatIsLessWork) {
  EXPECT_EQ(rows_of_share(1080, 2, {16, 4}, 120), 540);
  EXPECT_EQ(rows_of_share(1080, 5, {16, 4}, 120), 240);
  EXPECT_EQ(rows_of_share(240, 2, {16, 16}, 240), 128);
  EXPECT_EQ(rows_of_share(1080, 8, {16, 16}, 120), 144);
  EXPECT_EQ(rows_of_share(1080, 2, {32, 32}, 120), 544);
  EXPECT_EQ(rows_of_share(1080, 1, {32, 32}, 1), 1088);
  for (const int rows : {130, 1080, 2160, 2161})
    for (const size_t devices : {1, 2, 3, 8})
      for (const TileShape shape : {TileShape{128, 64}, TileShape{32, 16}, TileShape{16, 4}})
        for (const int block : {1, 60, 120, 240}) {
          const int share = rows_of_share(rows, devices, shape, block);
          EXPECT_EQ(share % shape.rows, 0);
          EXPECT_GE(size_t(share) * devices, size_t(rows));
          const int computed = rows_computed_by_one(rows, devices, shape, block);
          EXPECT_EQ(computed, counted_rows(rows, share, block)) << rows << " " << devices << " " << block;
          // The even shares of whole tiles, which do not know of blocks.
          const int tiles = (rows + shape.rows - 1) / shape.rows, even = (tiles + int(devices) - 1) / int(devices);
          EXPECT_LE(computed, counted_rows(rows, even * shape.rows, block)) << rows << " " << devices << " " << block;
        }
}

// Bands of one device: with room for it they end where blocks do, so that each row is computed once.
TEST(RowsOfDevices, OfBandsAreWholeBlocksIfTheyFit) {
  EXPECT_EQ(rows_of_band(700, {32, 32}, 120), 480);
  EXPECT_EQ(rows_of_band(500, {64, 16}, 240), 480);
  EXPECT_EQ(rows_of_band(300, {32, 32}, 120), 288);  // no 480: whole tiles
  EXPECT_EQ(rows_of_band(3, {32, 32}, 120), 32);
  EXPECT_EQ(rows_of_band(-1e9, {32, 32}, 1), 32);
}

// Lists of a sum on devices, by their sizes: the boxes that are left, as they are and as devices get them, and the waves of
// planes. Waves in the middle of a panel leave four boxes each, the most.
TEST(HostMemory, OfASumOnDevicesHoldsItsLists) {
  const Grid wide{600, 500, 8e-6};
  const Sources sources = make_random_sources(1000, {60, 60, 8e-6}, green, 55_mm, 56_mm);
  const PlanesTables tables({60, 5, 3, 1, true, false}, green, wide.pitch);
  const SortedWaves sorted = sort_waves(prepare_waves(sources, wide), tables.plan, green, wide.pitch);
  const PixelBox all{0, wide.nx, 0, wide.ny};
  std::vector<PreparedWave> rest;
  append_rest(sorted.waves, {wide, all, tables.plan.tile, tables.tangent}, rest);
  EXPECT_EQ(rest.capacity(), rest.size());
  EXPECT_GT(rest.size(), 3 * sorted.waves.size());
  const PacketedWaves packeted(sorted, tables, wide, all);
  const double bytes = double(rest.capacity() * (sizeof(PreparedWave) + sizeof(DeviceWave)) +
                              packeted.waves.capacity() * sizeof(DeviceWave));
  EXPECT_LE(bytes, (host_bytes_per_wave(true, Approach::planes) - host_bytes_per_wave(false, Approach::planes)) *
                       double(sorted.waves.size()));
}

}  // namespace
}  // namespace holotrace
