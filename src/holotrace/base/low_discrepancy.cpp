#include "holotrace/base/low_discrepancy.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "holotrace/base/low_discrepancy.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace holotrace::HWY_NAMESPACE {
namespace {

// The compiler turns these loops of sixteen into vectors.
void fill_block(const LowDiscrepancy::Seeds& seeds, LowDiscrepancy::Block* numbers) {
  uint32_t places[16];
  for (uint32_t i = 0; i < 16; ++i) places[i] = uint32_t(seeds.places >> 4 * i) << 28 | seeds.reversed_block;
  const uint32_t of_order = uint32_t(seeds.bits), of_x = seeds.x(), of_y = seeds.y();
  for (uint32_t i = 0; i < 16; ++i) {
    const uint32_t order = reverse_bits(scramble_reversed(places[i], of_order));
    numbers->x[i] = reverse_bits(scramble_reversed(order, of_x));
    numbers->y[i] = reverse_bits(scramble_reversed(second_sobol_reversed(order), of_y));
  }
}

}  // namespace
}  // namespace holotrace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace holotrace {

HWY_EXPORT(fill_block);

void LowDiscrepancy::fill(const Seeds& seeds, Block& numbers) { HWY_DYNAMIC_DISPATCH(fill_block)(seeds, &numbers); }

}  // namespace holotrace
#endif
