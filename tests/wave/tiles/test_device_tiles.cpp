// The tile-separable sum on every OpenCL device of this machine; scripts/setup installs PoCL, so there is one.

#include <gtest/gtest.h>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/tiles/device_tiles.h"
#include "holotrace/wave/tiles/device_wave.h"
#include "support/devices.h"
#include "support/fields.h"
#include "support/wavelengths.h"

namespace holotrace {
namespace {

using namespace literals;
using test::make_random_sources;
using test::relative_error;

class DeviceTiles : public test::OnEveryDevice {
 protected:
  // The same device, with another number of units in its description. With 2, the waves of the 35 tiles of 32 x 32 below are
  // summed in one piece; with 100 the sum wants 800 groups, and so cuts the waves into slices of 512 or more.
  Device with_units(int units) const {
    DeviceInfo info = device_.info();
    info.compute_units = units;
    return Device(info);
  }
};

HOLOTRACE_FOR_ALL_DEVICES(DeviceTiles);

// A wave at a pixel by its two factors, on the device and by the same text in C++, against the wave itself in double. On
// the axis of a tile the split is exact, so that only the factors' rounding is left.
struct DrawnFactors {
  std::vector<DeviceWave> waves;
  std::vector<FloatPair> x, y;
  std::vector<std::complex<float>> offsets;
  std::vector<std::complex<double>> expected;
};

DrawnFactors draw_factors(int count) {
  CounterRandom random(3, 0, 0);
  DrawnFactors drawn;
  const Grid pixel{1, 1, 8_um};
  for (int i = 0; i < count; ++i) {
    const double depth = 1_mm * std::pow(1e4, random.uniform());  // 1 mm to 10 m
    const auto within = [&](double most) { return (2 * random.uniform() - 1) * most; };
    const Source source{{within(0.1_m), within(0.1_m), -depth}, float(random.uniform()), float(within(pi))};
    const double x = source.origin.x + within(0.5 * depth), y = source.origin.y + within(0.5 * depth);
    const double offset = within(256_um);  // half of 64 pixels of 8 µm
    const bool is_along_x = random.uniform() < 0.5;
    const PreparedWave wave = prepare_wave(source, pixel, green);
    drawn.waves.push_back(device_wave(wave, green, {0, 1, 0, 1}));
    drawn.x.push_back(float_pair(x / green));
    drawn.y.push_back(float_pair(y / green));
    const auto at = float(offset / green);
    drawn.offsets.emplace_back(is_along_x ? at : 0.0F, is_along_x ? 0.0F : at);
    const double u = double(at) * green;
    drawn.expected.push_back(wave_at(wave, x + (is_along_x ? u : 0), y + (is_along_x ? 0 : u), green) /
                             double(source.amplitude));
    drawn.waves.back().amplitude = 1;
  }
  return drawn;
}

// Cycles along a tile are at most 256 µm/λ · sin 27° = 215; a float's ulp there is 1.5e-5 cycles, and some of them add up.
constexpr double factor_error = 4e-4;

TEST(TileFactors, InCppAreTheWavesOf1e5RandomPlaces) {
  const DrawnFactors drawn = draw_factors(100000);
  double worst = 0;
  for (size_t i = 0; i < drawn.waves.size(); ++i) {
    const auto t = tile_factor_kernel::wave_from_tile(drawn.waves[i], drawn.x[i], drawn.y[i]);
    const auto a = tile_factor_kernel::column_factor(t, drawn.offsets[i].real());
    const auto b = tile_factor_kernel::row_factor(t, drawn.offsets[i].imag());
    const std::complex<double> value = std::complex<double>(a.re, a.im) * std::complex<double>(b.re, b.im);
    worst = std::max(worst, std::abs(value - drawn.expected[i]));
  }
  EXPECT_LT(worst, factor_error);
}

TEST_P(DeviceTiles, HaveTheFactorsOfTheWavesAt1e5RandomPlaces) {
  const DrawnFactors drawn = draw_factors(100000);
  const auto lock = device_.lock();
  const DeviceBuffer waves = device_.upload(drawn.waves, "waves"), x = device_.upload(drawn.x, "places"),
                     y = device_.upload(drawn.y, "places"), offsets = device_.upload(drawn.offsets, "offsets"),
                     values = device_.make_buffer(8 * drawn.waves.size(), "values");
  device_.run(tile_kernel({64, 64}, "multiply_factors"), {drawn.waves.size() / 32, 1, 32, 1},
              {waves, x, y, offsets, values});
  std::vector<std::complex<float>> found(drawn.waves.size());
  device_.read(values, found.data(), values.bytes());
  double worst = 0;
  for (size_t i = 0; i < found.size(); ++i)
    worst = std::max(worst, std::abs(std::complex<double>(found[i]) - drawn.expected[i]));
  EXPECT_LT(worst, factor_error);
}

// 201 x 131 pixels: tiles of every shape extend past the right and the lower edge. Half of the boxes end on the panel.
constexpr Grid panel{201, 131, 8e-6};

Sources drawn_sources(int count) { return make_random_sources(count, panel, green, 5_mm, 30_mm, 0.3); }

Field sum_on(Device& device, const Sources& sources, TileShape shape) {
  Field field(panel, green);
  sum_tiles_on_device(device, prepare_waves(sources, panel), {panel, green}, shape, {0, panel.nx, 0, panel.ny},
                      field.samples, {});
  return field;
}

// A field whose tiles are split as those of the device, in double: all that differs is the rounding.
FieldDouble split_sum(const Sources& sources, TileShape tile) {
  FieldDouble field(panel, green);
  for (const PreparedWave& w : prepare_waves(sources, panel))
    for (int j = w.box.y0; j < w.box.y1; ++j)
      for (int i = w.box.x0; i < w.box.x1; ++i) {
        const double xc = panel.x(i / tile.columns * tile.columns + (tile.columns - 1) / 2.0);
        const double yc = panel.y(j / tile.rows * tile.rows + (tile.rows - 1) / 2.0);
        field.samples(j, i) +=
            wave_at(w, panel.x(i), yc, green) * wave_at(w, xc, panel.y(j), green) / wave_at(w, xc, yc, green);
      }
  return field;
}

// The products' rounding is 4e-6 (rounding_error); the factors' is the same for both devices and processors.
TEST_P(DeviceTiles, SumTheSplitWavesInTilesOfAnyShape) {
  const Sources sources = drawn_sources(150);
  for (const TileShape shape : {TileShape{128, 64}, TileShape{32, 32}, TileShape{16, 16}, TileShape{16, 4}})
    EXPECT_LT(relative_error(sum_on(device_, sources, shape), split_sum(sources, shape)), 4e-5)
        << shape.columns << "x" << shape.rows;
}

TEST_P(DeviceTiles, LightNothingOutsideTheBoxes) {
  // A wave 5 mm behind the panel lights 21 pixels on each side of it.
  const Sources sources{green, {{{0.2_mm, 0.1_mm, -5_mm}, 1, 0}}};
  const Field field = sum_on(device_, sources, {64, 64});
  const PixelBox box = prepare_waves(sources, panel).front().box;
  for (int j = 0; j < panel.ny; ++j)
    for (int i = 0; i < panel.nx; ++i)
      EXPECT_EQ(field.samples(j, i) != std::complex<float>(0), i >= box.x0 && i < box.x1 && j >= box.y0 && j < box.y1)
          << i << " " << j;
}

TEST_P(DeviceTiles, SendTheWavesFetchTheSamplesAndNothingElse) {
  const Sources sources = drawn_sources(3000);
  const size_t lit = prepare_waves(sources, panel).size();
  const DeviceUse before = device_.use();
  sum_on(device_, sources, {64, 64});
  const DeviceUse after = device_.use();
  // 48 bytes per wave, and 8 per place of 4 + 3 tile centres.
  EXPECT_EQ(after.bytes_in - before.bytes_in, 48 * lit + 8 * 7);
  EXPECT_EQ(after.bytes_out - before.bytes_out, 8u * size_t(panel.pixels()));
  EXPECT_EQ(after.bytes_held, 0u);
}

// 9000 waves take 430 kB, of which 4096 or more are sent at once; the field takes 211 kB, in bands of 32 rows or more. 80 %
// of the memory is used, less 100 kB.
constexpr double memory_for_two_parts = 600e3, memory_for_small_bands = 450e3;

TEST_P(DeviceTiles, GiveTheSameBytesInAnyMemory) {
  Device device = with_units(2);
  const Sources sources = drawn_sources(9000);
  const Field whole = sum_on(device, sources, {32, 32});
  EXPECT_EQ(sum_on(device, sources, {32, 32}).samples.values, whole.samples.values);
  for (const double memory : {memory_for_two_parts, memory_for_small_bands}) {
    const size_t before = device.use().bytes_in;
    device.limit_memory(memory);
    EXPECT_EQ(sum_on(device, sources, {32, 32}).samples.values, whole.samples.values) << memory;
    EXPECT_GE(device.use().bytes_in - before, 2 * 48 * prepare_waves(sources, panel).size()) << "sent for every band";
  }
  device.limit_memory(200e3);
  EXPECT_THROW(sum_on(device, sources, {32, 32}), Error);
  EXPECT_EQ(device.use().buffers, 0u);
}

TEST_P(DeviceTiles, GiveTheSameSumInSlicesOfTheWaves) {
  Device at_once = with_units(2), sliced = with_units(100);
  const Sources sources = drawn_sources(9000);
  const Field whole = sum_on(at_once, sources, {32, 32}), in_slices = sum_on(sliced, sources, {32, 32});
  EXPECT_NE(in_slices.samples.values, whole.samples.values) << "added in another order";
  EXPECT_LT(relative_error(in_slices, whole), 1e-5);  // rounding of sums of 9000 waves
  EXPECT_EQ(sliced.use().bytes_out, 8u * size_t(panel.pixels())) << "slices are added on the device";
  const size_t before = sliced.use().bytes_in;
  sliced.limit_memory(3e6);  // its slices of 211 kB each take more
  EXPECT_EQ(sum_on(sliced, sources, {32, 32}).samples.values, in_slices.samples.values);
  EXPECT_GT(sliced.use().bytes_in, before);
  sliced.guard_buffers(true);
  sum_on(sliced, sources, {32, 32});
  EXPECT_EQ(sliced.broken_guards(), 0u);
}

TEST_P(DeviceTiles, WriteNothingPastTheirBuffers) {
  const size_t before = device_.broken_guards();
  device_.guard_buffers(true);
  const Sources sources = drawn_sources(400);
  for (const TileShape shape : {TileShape{128, 64}, TileShape{32, 32}, TileShape{16, 4}})
    sum_on(device_, sources, shape);
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
}

TEST_P(DeviceTiles, FillTheirBoundsAndNothingElse) {
  const PixelBox bounds{30, 170, 21, 101};
  Sources sources = drawn_sources(50);
  std::vector<PreparedWave> waves = prepare_waves(sources, panel);
  for (PreparedWave& w : waves) w.box = intersect(w.box, bounds);
  Field field(panel, green);
  std::fill(field.samples.values.begin(), field.samples.values.end(), std::complex<float>(7));
  sum_tiles_on_device(device_, waves, {panel, green}, {16, 4}, bounds, field.samples, {});
  const FieldDouble exact = sum_exact(sources, panel);
  double error = 0, energy = 0;
  for (int j = 0; j < panel.ny; ++j)
    for (int i = 0; i < panel.nx; ++i)
      if (i >= bounds.x0 && i < bounds.x1 && j >= bounds.y0 && j < bounds.y1) {
        error += std::norm(std::complex<double>(field.samples(j, i)) - exact.samples(j, i));
        energy += std::norm(exact.samples(j, i));
      } else {
        EXPECT_EQ(field.samples(j, i), std::complex<float>(7));
      }
  EXPECT_LT(std::sqrt(error / energy), 1e-3);  // the split in tiles of 16 x 4 at 5 mm
}

TEST_P(DeviceTiles, ReportProgressUpToTheWhole) {
  std::vector<double> fractions;
  Observer observer;
  observer.on_progress = [&](double fraction) { fractions.push_back(fraction); };
  Field field(panel, green);
  Device device = with_units(2);
  device.limit_memory(memory_for_small_bands);
  sum_tiles_on_device(device, prepare_waves(drawn_sources(9000), panel), {panel, green}, {32, 32},
                      {0, panel.nx, 0, panel.ny}, field.samples, observer);
  ASSERT_GE(fractions.size(), 4u);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_NEAR(fractions.back(), 1, 1e-12);
}

}  // namespace
}  // namespace holotrace
