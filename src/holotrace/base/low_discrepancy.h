#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "holotrace/base/splitmix.h"
#include "holotrace/base/vec.h"

namespace holotrace {

/// Numbers that fill the unit square evenly, computed from counters: the same (seed, frame, sample,
/// index) gives the same numbers on any thread, in any order. One object serves one sample (a first
/// hit, a pixel); start(i) begins path i of it; each one() or two() is a new dimension of that path.
///
///     aᵢ = σ₀(i),   one() = σ₁(φ(aᵢ)),   two() = (σ₁(φ(aᵢ)), σ₂(ψ(aᵢ)))
///
/// φ is the base-2 radical inverse and ψ the second Sobol dimension, so (φ, ψ) is a (0, 2)-sequence. σ₁ and σ₂ are
/// nested uniform (Owen) scrambles by a hash, which move the points. σ₀ changes their order: first at random inside
/// each block of 16, then by such a scramble. All are keyed by (seed, frame, sample, dimension).
///
/// Properties that hold for each dimension by itself:
/// - Every number is uniform in [0, 1), so a mean over N paths is unbiased for every N.
/// - The first 2ᵐ points of a two(), and any aligned block of 2ᵐ ≥ 16 points, have exactly one point in each of the
///   2ᵐ boxes of 2⁻ᵃ × 2⁻ᵇ, a + b = m, for every a (a (0, m, 2)-net); a one() has one point in each interval of 2⁻ᵐ.
/// - So the error of the mean of a smooth f(two()) over N = 2ᵐ paths falls as N^(−3/2)·√log N; with independent
///   numbers it falls as N^(−1/2). Use a power of two as N, or at least a multiple of 16.
/// Different dimensions and different samples are uncorrelated (padded), so the part of an integrand that is a product
/// of several dimensions keeps N^(−1/2). Without the random order inside blocks, paths 2j and 2j + 1 would lie in
/// opposite halves of every dimension, and (x − ½)(x′ − ½) of two dimensions would have 1.58 times the variance of
/// independent numbers; with it, 1.07 times.
/// Limits: numbers have 32 bits, and so has the index. The hash replaces independent random swaps, to which it is not
/// exactly equal; tests check the statistics.
///
/// Cost: two() takes about 2.5 times as long as two numbers of CounterRandom, one() about 4 times as long as one.
/// Reference: B. Burley, Practical Hash-based Owen Scrambling, JCGT 9(4), 2020, with the hash of N. Vegdahl, Building a
/// Better LK Hash, 2021; A. B. Owen, Scrambled net variance for integrals of smooth functions, Ann. Stat. 25, 1997.
class LowDiscrepancy {
 public:
  LowDiscrepancy(uint64_t seed, uint32_t frame, uint64_t sample)
      : key_(mix(mix(mix(seed) + frame) + sample * splitmix_step)), next_(key_) {}

  /// Starts path `index` of this sample at its first dimension.
  void start(uint32_t index) {
    reversed_block_ = reverse_bits(index >> 4) >> 4;
    block_hash_ = uint32_t((index >> 4) * splitmix_step >> 32);
    place_ = 4 * (index & 15);
    first_order_ = index < 16 ? 0 : 64;
    next_ = key_;
  }

  /// Leaves out the next dimensions; each one() and each two() is one.
  void skip(int dimensions) { next_ += uint64_t(dimensions) * splitmix_step; }

  /// The next single dimension, uniform in [0, 1).
  double one() {
    const uint64_t bits = next_seeds();
    const uint32_t order = shuffled_order(uint32_t(bits));
    return reverse_bits(scramble_reversed(order, uint32_t(bits >> 32))) * 0x1p-32;
  }

  /// The next two dimensions together, uniform in [0, 1)².
  Vec2 two() {
    const uint64_t bits = next_seeds();
    const uint32_t order = shuffled_order(uint32_t(bits));
    const uint32_t x = scramble_reversed(order, uint32_t(bits >> 32));
    const uint32_t y = scramble_reversed(second_sobol_reversed(order), uint32_t(bits * splitmix_step >> 32));
    // One reversal of 64 bits reverses both numbers, and swaps their places.
    const uint64_t both = reverse_bits(uint64_t(y) << 32 | x);
    return {uint32_t(both >> 32) * 0x1p-32, uint32_t(both) * 0x1p-32};
  }

  /// Numbers of two() in units of 2⁻³², for the paths of a block.
  struct Block {
    std::array<uint32_t, 16> x, y;
  };

  /// What start(16·block + i), skip(dimension) and two() give for i = 0 … 15.
  Block two_of_block(uint32_t block, int dimension) const {
    LowDiscrepancy path = *this;
    path.start(16 * block);
    path.skip(dimension);
    const uint64_t bits = path.next_seeds();
    const uint64_t places = orders[path.first_order_ + ((uint32_t(bits) + path.block_hash_) >> 26)];
    Block numbers;
    for (uint32_t i = 0; i < 16; ++i) numbers.x[i] = uint32_t(places >> 4 * i) << 28 | path.reversed_block_;
    for (uint32_t i = 0; i < 16; ++i) {
      const uint32_t order = reverse_bits(scramble_reversed(numbers.x[i], uint32_t(bits)));
      numbers.x[i] = reverse_bits(scramble_reversed(order, uint32_t(bits >> 32)));
      numbers.y[i] =
          reverse_bits(scramble_reversed(second_sobol_reversed(order), uint32_t(bits * splitmix_step >> 32)));
    }
    return numbers;
  }

 private:
  static constexpr uint32_t reverse_bits(uint32_t v) {
    v = (v & 0x55555555) << 1 | (v >> 1 & 0x55555555);
    v = (v & 0x33333333) << 2 | (v >> 2 & 0x33333333);
    v = (v & 0x0f0f0f0f) << 4 | (v >> 4 & 0x0f0f0f0f);
    return __builtin_bswap32(v);
  }

  static uint64_t reverse_bits(uint64_t v) {
    v = (v & 0x5555555555555555) << 1 | (v >> 1 & 0x5555555555555555);
    v = (v & 0x3333333333333333) << 2 | (v >> 2 & 0x3333333333333333);
    v = (v & 0x0f0f0f0f0f0f0f0f) << 4 | (v >> 4 & 0x0f0f0f0f0f0f0f0f);
    return __builtin_bswap64(v);
  }

  /// A nested uniform scramble of a number whose bits are in reverse order. Addition, multiplication by odd numbers
  /// and v ^ v·even let a bit change only higher bits, just as a scramble lets a digit change only later digits.
  static uint32_t scramble_reversed(uint32_t v, uint32_t seed) {
    v ^= v * 0x3d20adea;
    v += seed;
    v *= seed >> 16 | 1;
    v ^= v * 0x05526c56;
    return v ^ v * 0x53a22864;
  }

  /// The second Sobol dimension of point `order`, with its bits in reverse order. Its generator matrix is Pascal's
  /// triangle modulo 2: C(k, j) is odd where the bits of j are among those of k (Lucas), so bit j sums all such k.
  static uint32_t second_sobol_reversed(uint32_t order) {
    order ^= order >> 1 & 0x55555555;
    order ^= order >> 2 & 0x33333333;
    order ^= order >> 4 & 0x0f0f0f0f;
    order ^= order >> 8 & 0x00ff00ff;
    return order ^ order >> 16;
  }

  /// 64 bits for the next dimension: σ₀ takes the lower half, σ₁ the upper half, σ₂ the upper half of a multiple.
  uint64_t next_seeds() { return mix(next_ += splitmix_step); }

  /// σ₀(i): first the place of the point in its block of 16, then a scramble of the whole index.
  uint32_t shuffled_order(uint32_t seed) const {
    const uint64_t order = orders[first_order_ + ((seed + block_hash_) >> 26)];
    return reverse_bits(scramble_reversed(uint32_t(order >> place_) << 28 | reversed_block_, seed));
  }

  /// Random orders of 16 places, each place four bits in reverse order. The first 64 orders are for the first block:
  /// they permute only within 2–3, 4–7 and 8–15, so that its first 1, 2, 4, 8 points stay the same. 64 are for others.
  static constexpr std::array<uint64_t, 128> make_orders() {
    std::array<uint64_t, 128> orders{};
    for (size_t n = 0; n < orders.size(); ++n) {
      std::array<uint32_t, 16> place{};
      for (uint32_t i = 0; i < 16; ++i) {  // Fisher–Yates shuffle, built up from the start
        const uint32_t first = n < 64 ? std::bit_floor(i) : 0;
        const uint32_t other = first + uint32_t((mix(16 * n + i + 1) >> 32) * (i + 1 - first) >> 32);
        place[i] = place[other];
        place[other] = i;
      }
      for (uint32_t i = 0; i < 16; ++i) orders[n] |= uint64_t(reverse_bits(place[i]) >> 28) << 4 * i;
    }
    return orders;
  }
  static const std::array<uint64_t, 128> orders;

  uint64_t key_, next_;
  uint32_t reversed_block_ = 0, block_hash_ = 0, place_ = 0, first_order_ = 0;  // state of the current path
};

inline constexpr std::array<uint64_t, 128> LowDiscrepancy::orders = make_orders();

}  // namespace holotrace
