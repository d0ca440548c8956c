#pragma once

#include <cstdint>
#include <string>

namespace holotrace {

/// A real matrix product of pairs of bf16 numbers, summed in single precision: sums += Σ over terms of rows × columns.
/// A word holds a pair, the numbers of two waves, the first in its low half. A block is 16 columns.
struct PackedProduct {
  struct Term {
    const uint32_t* rows;     ///< [row][pair], `pair_stride` words from row to row
    const uint32_t* columns;  ///< [block][pair][16], `pair_stride` pairs from block to block
  };
  Term terms[3];
  int term_count;
  int pairs;  ///< pairs in use, a multiple of 16
  int pair_stride;
  int row_count;     ///< a multiple of 32
  int column_count;  ///< a multiple of 32
  float* sums;       ///< [row][column]
};

/// The unit of this processor that computes such products.
enum class PackedUnit { none, avx512_bf16, amx };

/// The fastest unit of this machine. The first call asks the operating system for permission to use AMX.
PackedUnit packed_unit();

/// "AMX", "AVX512_BF16" or "none".
std::string packed_unit_name();

/// @param unit  a unit that this machine has
void multiply_packed(const PackedProduct& product, PackedUnit unit);

}  // namespace holotrace
