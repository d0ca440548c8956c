#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "holotrace/base/random.h"
#include "holotrace/base/vec.h"

namespace holotrace {

// Nested uniform (Owen) scrambles of binary fractions, and the two sequences that are scrambled here.

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
/// Cost: the first path of each block of 16 takes 12 ns for two() or one(). When a second path of the block asks for a
/// dimension, its numbers for all 16 paths are computed in vector lanes and kept: 2 ns for each number. Paths of a block are
/// best drawn one after another.
/// Reference: B. Burley, Practical Hash-based Owen Scrambling, JCGT 9(4), 2020, with the hash of N. Vegdahl, Building a
/// Better LK Hash, 2021; A. B. Owen, Scrambled net variance for integrals of smooth functions, Ann. Stat. 25, 1997.
class LowDiscrepancy {
 public:
  LowDiscrepancy(uint64_t seed, uint32_t frame, uint64_t sample)
      : key_(mix(mix(mix(seed) + frame) + sample * splitmix_step)) {}

  /// Starts path `index` of this sample at its first dimension.
  void start(uint32_t index) {
    dimension_ = 0;
    path_ = index & 15;
    has_block_ = has_started_ && block_ == index >> 4;
    if (has_block_) return;
    has_started_ = true;
    block_ = index >> 4;
    kept_ = 0;
  }

  /// Goes to a path of the current path's block, 0 … 15, and to a dimension of it.
  void go_to(uint32_t path_of_block, int dimension) {
    start(block_ << 4 | path_of_block);
    dimension_ = dimension;
  }

  /// Leaves out the next dimensions; each one() and each two() is one.
  void skip(int dimensions) { dimension_ += dimensions; }

  /// The next single dimension, uniform in [0, 1).
  double one() {
    const int dimension = dimension_++;
    if (const Block* block = kept_block(dimension)) return block->x[path_] * 0x1p-32;
    const Seeds seeds = seeds_of(block_, dimension);
    return reverse_bits(scramble_reversed(seeds.order(path_), seeds.x())) * 0x1p-32;
  }

  /// The next two dimensions together, uniform in [0, 1)².
  Vec2 two() {
    const int dimension = dimension_++;
    if (const Block* block = kept_block(dimension)) return {block->x[path_] * 0x1p-32, block->y[path_] * 0x1p-32};
    const Seeds seeds = seeds_of(block_, dimension);
    const uint32_t order = seeds.order(path_);
    const uint32_t x = scramble_reversed(order, seeds.x());
    const uint32_t y = scramble_reversed(second_sobol_reversed(order), seeds.y());
    // One reversal of 64 bits reverses both numbers, and swaps their places.
    const uint64_t both = reverse_bits(uint64_t(y) << 32 | x);
    return {uint32_t(both >> 32) * 0x1p-32, uint32_t(both) * 0x1p-32};
  }

  /// Numbers of two() in units of 2⁻³², for the paths of a block.
  struct Block {
    std::array<uint32_t, 16> x, y;
  };

  /// The stratum of the current path, 0 … count − 1: paths take the strata one after another, from a random one of the sample on. This
  /// takes no dimension.
  int stratum(int count) const { return int((mix(key_) + (uint64_t(block_) << 4 | path_)) % uint64_t(count)); }

  /// Number of dimensions that the current path has taken.
  int dimension() const { return dimension_; }

  /// The numbers of a dimension for all paths of the current path's block, until the next call.
  const Block& of_block(int dimension) {
    const bool is_kept = dimension < most_kept;
    Block& numbers = blocks_[size_t(is_kept ? dimension : most_kept)];
    if (is_kept && (kept_ >> dimension & 1)) return numbers;
    fill(seeds_of(block_, dimension), numbers);
    if (is_kept) kept_ |= 1U << dimension;
    return numbers;
  }

  /// What start(16·block + i), skip(dimension) and two() give for i = 0 … 15.
  Block two_of_block(uint32_t block, int dimension) const {
    Block numbers;
    fill(seeds_of(block, dimension), numbers);
    return numbers;
  }

  /// What decides the numbers of one dimension for the paths of a block.
  struct Seeds {
    uint64_t bits;            ///< σ₀ takes the lower half, σ₁ the upper half, σ₂ the upper half of a multiple
    uint64_t places;          ///< random order of the paths in the block
    uint32_t reversed_block;  ///< number of the block with its bits in reverse order

    uint32_t x() const { return uint32_t(bits >> 32); }
    uint32_t y() const { return uint32_t(bits * splitmix_step >> 32); }

    /// σ₀(i): first the place of the point in its block of 16, then a scramble of the whole index.
    uint32_t order(uint32_t path) const {
      return reverse_bits(scramble_reversed(uint32_t(places >> 4 * path) << 28 | reversed_block, uint32_t(bits)));
    }
  };

 private:
  static void fill(const Seeds& seeds, Block& numbers);

  /// The numbers of this dimension for all paths of the block; none at the block's first path.
  const Block* kept_block(int dimension) {
    return has_block_ && dimension < most_kept ? &of_block(dimension) : nullptr;
  }

  Seeds seeds_of(uint32_t block, int dimension) const {
    const uint64_t bits = mix(key_ + uint64_t(dimension + 1) * splitmix_step);
    const auto hash = uint32_t(block * splitmix_step >> 32);
    const size_t order = (block == 0 ? 0 : 64) + ((uint32_t(bits) + hash) >> 26);
    return {bits, orders[order], reverse_bits(block) >> 4};
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

  uint64_t key_;
  uint32_t block_ = 0, path_ = 0;  // the current path: its block, and its number there
  int dimension_ = 0;
  bool has_started_ = false, has_block_ = false;  // a path; an earlier path of this block

  static constexpr int most_kept = 32;       // dimensions: those of a path of ten surfaces
  uint32_t kept_ = 0;                        // bits: dimensions whose numbers are in blocks_
  std::array<Block, most_kept + 1> blocks_;  // the last: of a dimension that is not kept
};

inline constexpr std::array<uint64_t, 128> LowDiscrepancy::orders = make_orders();

}  // namespace holotrace
