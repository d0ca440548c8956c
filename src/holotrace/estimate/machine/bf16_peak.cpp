#include "holotrace/base/machine.h"
#include "holotrace/estimate/machine/ceilings.h"
#include "holotrace/estimate/machine/timing.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace holotrace {

#if defined(__x86_64__)
namespace {

constexpr int steps = 10000;
constexpr int chains = 12;  // number of independent sums

// The sums start at different values and all are written, so the compiler cannot remove any of them.
__attribute__((target("avx512f,avx512bw,avx512vl,avx512bf16"))) void vector_products(float start, float* sums_out) {
  const __m512bh a = _mm512_cvtne2ps_pbh(_mm512_set1_ps(start), _mm512_set1_ps(start));
  __m512 sums[chains];
#pragma GCC unroll 16
  for (int c = 0; c < chains; ++c) sums[c] = _mm512_set1_ps(start * float(c));
  for (int s = 0; s < steps; ++s)
#pragma GCC unroll 16
    for (int c = 0; c < chains; ++c) sums[c] = _mm512_dpbf16_ps(sums[c], a, a);
#pragma GCC unroll 16
  for (int c = 0; c < chains; ++c) _mm512_storeu_ps(sums_out + 16 * c, sums[c]);
}

struct alignas(64) TileShapes {
  uint8_t palette, start_row, reserved[14];
  uint16_t row_bytes[16];
  uint8_t rows[16];
};

// Eight tiles of 16 rows of 64 bytes. In static memory: GCC 12 assumes that _tile_loadconfig reads 8 bytes, and would
// remove the code that writes the rest.
const TileShapes eight_tiles{1, 0, {}, {64, 64, 64, 64, 64, 64, 64, 64}, {16, 16, 16, 16, 16, 16, 16, 16}};

// Four tiles of sums, 16 × 16 each, and two by two tiles of factors, as in the inner loop of a matrix product.
__attribute__((target("amx-tile,amx-bf16"))) void tile_products() {
  _tile_loadconfig(&eight_tiles);  // clears the tiles
  for (int s = 0; s < steps; ++s) {
    _tile_dpbf16ps(0, 4, 6);
    _tile_dpbf16ps(1, 4, 7);
    _tile_dpbf16ps(2, 5, 6);
    _tile_dpbf16ps(3, 5, 7);
  }
  _tile_release();
}

}  // namespace

double measure_bf16_vector_peak() {
  if (!has_avx512_bf16()) return 0;
  return 32.0 * chains * steps * peak_call_rate([] {
           thread_local float sums[16 * chains];
           vector_products(1e-3F, sums);
         });
}

double measure_bf16_tile_peak() {
  if (!enable_amx_bf16()) return 0;
  return 4.0 * 16 * 16 * 32 * steps * peak_call_rate([] { tile_products(); });
}

#else

double measure_bf16_vector_peak() { return 0; }
double measure_bf16_tile_peak() { return 0; }

#endif

}  // namespace holotrace
