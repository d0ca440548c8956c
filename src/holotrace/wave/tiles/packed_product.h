#pragma once

#include <cstdint>
#include <string>

namespace holotrace {

/// A real matrix product of pairs of bf16 numbers, summed in single precision: sums += Σ over terms of rows × columns.
/// A word holds the pair of two waves, the first in its low half; a block is 16 columns.
struct PackedProduct {
  struct Term {
    const uint32_t* rows;     ///< [row][pair], `pair_stride` words from row to row
    const uint32_t* columns;  ///< [block][pair][16], `pair_stride` pairs from block to block
  };
  Term terms[3];
  int term_count;
  int pairs;  ///< in use, a multiple of 16
  int pair_stride;
  int row_count;     ///< a multiple of 32
  int column_count;  ///< a multiple of 32
  float* sums;       ///< [row][column]
};

/// The unit of this processor that makes such products fastest.
enum class PackedUnit { none, avx512_bf16, amx };

/// What this machine has; asks the system for the use of AMX on the first call.
PackedUnit packed_unit();

/// "AMX", "AVX512_BF16" or "none".
std::string packed_unit_name();

/// @param unit  one that this machine has
void multiply_packed(const PackedProduct& product, PackedUnit unit);

}  // namespace holotrace
