#include "holotrace/wave/tiles/packed_product.h"

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define HOLOTRACE_HAS_PACKED_PRODUCTS 1
#endif

namespace holotrace {

PackedUnit packed_unit() {
#ifdef HOLOTRACE_HAS_PACKED_PRODUCTS
  static const PackedUnit unit = enable_amx_bf16()   ? PackedUnit::amx
                                 : has_avx512_bf16() ? PackedUnit::avx512_bf16
                                                     : PackedUnit::none;
  return allows_best_instruction_set() ? unit : PackedUnit::none;  // both belong to processors with AVX-512
#else
  return PackedUnit::none;
#endif
}

std::string packed_unit_name() {
  return packed_unit() == PackedUnit::amx ? "AMX" : packed_unit() == PackedUnit::avx512_bf16 ? "AVX512_BF16" : "none";
}

#ifdef HOLOTRACE_HAS_PACKED_PRODUCTS
namespace {

// Registers of AMX: sums 0–3 (two by two), rows 4 and 5, columns 6 and 7, each 16 lines of 64 bytes. Objects of this
// type must be static: the compiler does not see that _tile_loadconfig reads them, and would drop the stores.
struct alignas(64) TileConfiguration {
  uint8_t palette = 1, start_row = 0, reserved[14] = {};
  uint16_t bytes[16] = {64, 64, 64, 64, 64, 64, 64, 64};
  uint8_t lines[16] = {16, 16, 16, 16, 16, 16, 16, 16};
};

__attribute__((target("amx-tile,amx-bf16"))) void multiply_by_amx(const PackedProduct& p) {
  constexpr int line = 16;  // words in a line of a register
  static const TileConfiguration configuration;
  _tile_loadconfig(&configuration);
  const size_t row_step = size_t(p.pair_stride) * sizeof(uint32_t), sum_step = size_t(p.column_count) * sizeof(float);
  const size_t block_step = size_t(p.pair_stride) * line;
  for (int c = 0; c < p.column_count; c += 2 * line)
    for (int r = 0; r < p.row_count; r += 2 * line) {
      float* const sums = p.sums + size_t(r) * size_t(p.column_count) + c;
      float* const below = sums + size_t(line) * size_t(p.column_count);
      _tile_loadd(0, sums, sum_step);
      _tile_loadd(1, sums + line, sum_step);
      _tile_loadd(2, below, sum_step);
      _tile_loadd(3, below + line, sum_step);
      for (int t = 0; t < p.term_count; ++t) {
        const uint32_t* rows = p.terms[t].rows + size_t(r) * size_t(p.pair_stride);
        const uint32_t* columns = p.terms[t].columns + size_t(c / line) * block_step;
        for (int k = 0; k < p.pairs; k += line) {
          _tile_loadd(4, rows + k, row_step);
          _tile_loadd(5, rows + size_t(line) * size_t(p.pair_stride) + k, row_step);
          _tile_loadd(6, columns + size_t(k) * line, line * sizeof(uint32_t));
          _tile_loadd(7, columns + block_step + size_t(k) * line, line * sizeof(uint32_t));
          _tile_dpbf16ps(0, 4, 6);
          _tile_dpbf16ps(1, 4, 7);
          _tile_dpbf16ps(2, 5, 6);
          _tile_dpbf16ps(3, 5, 7);
        }
      }
      _tile_stored(0, sums, sum_step);
      _tile_stored(1, sums + line, sum_step);
      _tile_stored(2, below, sum_step);
      _tile_stored(3, below + line, sum_step);
    }
  _tile_release();
}

constexpr int block_rows = 8, block_vectors = 2;  // 16 of 32 registers hold sums

__attribute__((target("avx512f,avx512bw,avx512vl,avx512bf16"))) void multiply_by_avx512(const PackedProduct& p) {
  constexpr int line = 16;
  const size_t block_step = size_t(p.pair_stride) * line;
  for (int c = 0; c < p.column_count; c += block_vectors * line)
    for (int r = 0; r < p.row_count; r += block_rows) {
      __m512 sums[block_rows][block_vectors];
      float* const to = p.sums + size_t(r) * size_t(p.column_count) + c;
#pragma GCC unroll 8
      for (int i = 0; i < block_rows; ++i)
#pragma GCC unroll 2
        for (int v = 0; v < block_vectors; ++v)
          sums[i][v] = _mm512_loadu_ps(to + size_t(i) * size_t(p.column_count) + v * line);
      for (int t = 0; t < p.term_count; ++t) {
        const uint32_t* rows = p.terms[t].rows + size_t(r) * size_t(p.pair_stride);
        const uint32_t* columns = p.terms[t].columns + size_t(c / line) * block_step;
        for (int k = 0; k < p.pairs; ++k) {
          const __m512bh first = (__m512bh)_mm512_loadu_si512(columns + size_t(k) * line);
          const __m512bh second = (__m512bh)_mm512_loadu_si512(columns + block_step + size_t(k) * line);
#pragma GCC unroll 8
          for (int i = 0; i < block_rows; ++i) {
            const __m512bh row = (__m512bh)_mm512_set1_epi32(int(rows[size_t(i) * size_t(p.pair_stride) + size_t(k)]));
            sums[i][0] = _mm512_dpbf16_ps(sums[i][0], row, first);
            sums[i][1] = _mm512_dpbf16_ps(sums[i][1], row, second);
          }
        }
      }
#pragma GCC unroll 8
      for (int i = 0; i < block_rows; ++i)
#pragma GCC unroll 2
        for (int v = 0; v < block_vectors; ++v)
          _mm512_storeu_ps(to + size_t(i) * size_t(p.column_count) + v * line, sums[i][v]);
    }
}

}  // namespace

void multiply_packed(const PackedProduct& product, PackedUnit unit) {
  if (unit == PackedUnit::amx)
    multiply_by_amx(product);
  else
    multiply_by_avx512(product);
}

#else

void multiply_packed(const PackedProduct&, PackedUnit) {
  throw Error("this processor has no products of bf16 numbers");
}

#endif

}  // namespace holotrace
