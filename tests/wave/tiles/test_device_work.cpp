// Operations of the device's tiles, counted by running their formulas with a number that counts.

#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/wave/tiles/device_tiles.h"

namespace counting {

int operations = 0;

// A division or a root counts as 4 operations, a comparison or a change of sign as none.
struct Number {
  float value = 0;
  Number() = default;
  Number(double value) : value(float(value)) {}
  Number counted(int cost = 1) const {
    operations += cost;
    return *this;
  }
};
Number operator-(Number a) { return {-double(a.value)}; }
Number operator+(Number a, Number b) { return Number(double(a.value) + b.value).counted(); }
Number operator-(Number a, Number b) { return Number(double(a.value) - b.value).counted(); }
Number operator*(Number a, Number b) { return Number(double(a.value) * b.value).counted(); }
Number operator/(Number a, Number b) { return Number(double(a.value) / b.value).counted(4); }
Number sqrt(Number a) { return Number(std::sqrt(a.value)).counted(4); }
Number floor(Number a) { return Number(std::floor(a.value)).counted(); }
Number fma(Number a, Number b, Number c) { return Number(std::fma(a.value, b.value, c.value)).counted(); }

}  // namespace counting

// The same text with other types and in another namespace; the header itself may be included once only.
#define float counting::Number
#define tile_factor_kernel counted_factor_kernel
#include "holotrace/wave/tiles/tile_factor_kernel.h"
#undef tile_factor_kernel
#undef float

namespace holotrace {
namespace {

using namespace counted_factor_kernel;

template <class Work>
int operations_of(const Work& work) {
  counting::operations = 0;
  work();
  return counting::operations;
}

// The goal of the device's sum is at most 4.5 multiply-adds per wave and pixel, in the tiles of usual tolerances.
TEST(DeviceWork, IsWhatTheFormulasTake) {
  const DeviceWave wave{{1000, 0}, {2000, 0}, {4e5, 0}, 0.25, 1, 0, 9, 0, 9};
  TileWave tile;
  const int of_wave = operations_of([&] { tile = wave_from_tile(wave, {0, 0}, {0, 0}); });
  const int of_factor =
      std::max(operations_of([&] { column_factor(tile, 100); }), operations_of([&] { row_factor(tile, 100); }));
  for (const TileShape shape : {TileShape{128, 64}, TileShape{64, 64}}) {
    // A device has an instruction for 1/root, counted as 4 and not 8, and flips a sign by 2. tile_sum.cl adds: 3 products; per factor its offset (2), its sum (1) and two selections; per wave 12 comparisons and
    // differences, and two additions for each item of its group of 4 x 8 pixels an item.
    const double pixels = shape.columns * shape.rows, items = pixels / 32;
    const double counted =
        3 + ((of_factor - 4 + 2 + 5.0) * (shape.columns + shape.rows) + of_wave + 12 + 2 * items) / pixels;
    EXPECT_NEAR(multiply_adds_per_wave_pixel(shape), counted, 0.02 * counted);
    EXPECT_LE(counted, 4.5) << shape.columns << "x" << shape.rows;
  }
}

}  // namespace
}  // namespace holotrace
