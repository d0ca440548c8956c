#pragma once

#include <cstdint>

// Nested uniform (Owen) scrambles of binary fractions, and the two sequences that low_discrepancy.h scrambles.

namespace holotrace {

constexpr uint32_t reverse_bits(uint32_t v) {
  v = (v & 0x55555555) << 1 | (v >> 1 & 0x55555555);
  v = (v & 0x33333333) << 2 | (v >> 2 & 0x33333333);
  v = (v & 0x0f0f0f0f) << 4 | (v >> 4 & 0x0f0f0f0f);
  return __builtin_bswap32(v);
}

constexpr uint64_t reverse_bits(uint64_t v) {
  v = (v & 0x5555555555555555) << 1 | (v >> 1 & 0x5555555555555555);
  v = (v & 0x3333333333333333) << 2 | (v >> 2 & 0x3333333333333333);
  v = (v & 0x0f0f0f0f0f0f0f0f) << 4 | (v >> 4 & 0x0f0f0f0f0f0f0f0f);
  return __builtin_bswap64(v);
}

/// A nested uniform scramble of a number whose bits are in reverse order. Addition, multiplication by odd numbers
/// and v ^ v·even let a bit change only higher bits, just as a scramble lets a digit change only later digits.
constexpr uint32_t scramble_reversed(uint32_t v, uint32_t seed) {
  v ^= v * 0x3d20adea;
  v += seed;
  v *= seed >> 16 | 1;
  v ^= v * 0x05526c56;
  return v ^ v * 0x53a22864;
}

/// The second Sobol dimension of point `order`, with its bits in reverse order. Its generator matrix is Pascal's
/// triangle modulo 2: C(k, j) is odd where the bits of j are among those of k (Lucas), so bit j sums all such k.
constexpr uint32_t second_sobol_reversed(uint32_t order) {
  order ^= order >> 1 & 0x55555555;
  order ^= order >> 2 & 0x33333333;
  order ^= order >> 4 & 0x0f0f0f0f;
  order ^= order >> 8 & 0x00ff00ff;
  return order ^ order >> 16;
}

}  // namespace holotrace
