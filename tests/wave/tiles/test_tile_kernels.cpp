#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "holotrace/base/machine.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/summation.h"
#include "holotrace/wave/tiles/packed_product.h"
#include "holotrace/wave/tiles/tile_sum.h"
#include "support/fields.h"
#include "support/wavelengths.h"

// The kernels of the fast sums, for every instruction set and every kind of product of this machine.

namespace holotrace {
namespace {

using namespace literals;
using test::make_random_sources;
using test::relative_error;

// Sums and fused multiply-adds differ in order: rounding of a float, 6e-8, in √waves terms that mostly cancel.
constexpr double bound_between_sets = 5e-6;

TEST(InstructionSets, GiveTheSameFieldsToTheStatedBound) {
  const Grid grid{300, 170, 8_um};
  const Sources sources = make_random_sources(150, grid, green, 0.15_m, 0.25_m, 0.4);
  const FieldDouble exact = sum_exact(sources, grid);
  const FieldDouble tiled = convert<double>(sum_tiled(sources, grid, 1e-3));
  const FieldDouble planes = convert<double>(sum_planes(sources, grid, 1e-3));
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet on(name);
    const Field by_tiles = sum_tiled(sources, grid, 1e-3), by_planes = sum_planes(sources, grid, 1e-3);
    EXPECT_LT(relative_error(by_tiles, exact), 1e-3) << name;
    EXPECT_LT(relative_error(by_tiles, tiled), bound_between_sets) << name;
    EXPECT_LT(relative_error(by_planes, exact), 1e-3) << name;
    EXPECT_LT(relative_error(by_planes, planes), bound_between_sets) << name;
  }
}

// One tile by one kind of product. The waves cover it or cut it; they are fewer than a batch or more than one.
Field one_tile(const Sources& sources, TileShape shape, TileProducts products) {
  const Grid grid{shape.columns, shape.rows, 8_um};
  Field field(grid, green);
  TileWorkspace workspace;
  const std::vector<PreparedWave> waves = prepare_waves(sources, grid);
  list_waves(waves, {0, grid.nx, 0, grid.ny}, workspace.waves);
  sum_tile(workspace.waves, {grid, green}, {shape, products}, {0, grid.nx, 0, grid.ny}, workspace, field.samples);
  return field;
}

TEST(TileProducts, LeaveTheirStatedRounding) {
  if (packed_unit() == PackedUnit::none) GTEST_SKIP() << "this processor has no products of bf16 numbers";
  for (const TileShape shape : {TileShape{128, 120}, {64, 60}, {64, 30}})
    for (const int count : {1, 31, 300}) {
      const Grid grid{shape.columns, shape.rows, 8_um};
      const Sources sources = make_random_sources(count, grid, green, 0.02_m, 0.3_m, 2);
      const FieldDouble single = convert<double>(one_tile(sources, shape, TileProducts::single));
      for (const TileProducts products : {TileProducts::bf16, TileProducts::split_bf16}) {
        const double error = relative_error(one_tile(sources, shape, products), single);
        // The rounding of a few waves varies about its mean square.
        EXPECT_LT(error, rounding_error(products) * (count < 100 ? 1.4 : 1.1)) << count;
        EXPECT_GT(error, rounding_error(products) / 20) << "rounded, or not packed at all";
      }
    }
}

TEST(TileProducts, OfBothUnitsAreTheSame) {
  if (!enable_amx_bf16() || !has_avx512_bf16()) GTEST_SKIP() << "this processor has not both units";
  constexpr int rows = 64, columns = 96, pairs = 48, stride = 64;
  std::vector<uint32_t> a(rows * stride), b(columns / 16 * stride * 16);
  CounterRandom random(3, 0, 0);
  const auto bf16 = [&] {  // of either sign, between 0.5 and 1: exponent 126
    return uint32_t(random.uniform() < 0.5 ? 0x3f00 : 0xbf00) + uint32_t(random.uniform() * 128);
  };
  for (uint32_t& word : a) word = bf16() | bf16() << 16;
  for (uint32_t& word : b) word = bf16() | bf16() << 16;
  std::vector<float> amx(rows * columns, 1.0F), avx512(rows * columns, 1.0F);
  const auto product = [&](std::vector<float>& sums) {
    return PackedProduct{{{a.data(), b.data()}}, 1, pairs, stride, rows, columns, sums.data()};
  };
  multiply_packed(product(amx), PackedUnit::amx);
  multiply_packed(product(avx512), PackedUnit::avx512_bf16);
  const auto number = [](uint32_t word, int half) {
    const uint32_t bits = half ? word & 0xffff0000U : word << 16;
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return double(value);
  };
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      double sum = 1;
      for (int k = 0; k < pairs; ++k)
        for (int half = 0; half < 2; ++half)
          sum += number(a[size_t(r * stride + k)], half) * number(b[size_t((c / 16 * stride + k) * 16 + c % 16)], half);
      // 96 products below 1 in floats.
      EXPECT_NEAR(amx[size_t(r * columns + c)], sum, 1e-4);
      EXPECT_NEAR(avx512[size_t(r * columns + c)], sum, 1e-4);
    }
}

}  // namespace
}  // namespace holotrace
