#pragma once

#include <Random123/philox.h>

#include <cstdint>

namespace holotrace {

/// Random numbers drawn from a counter: the same (seed, frame, sample) gives the same sequence on
/// any thread, in any order (Philox4x32-10; Salmon et al., SC 2011).
class CounterRandom {
 public:
  CounterRandom(uint64_t seed, uint32_t frame, uint64_t sample)
      : key_{{uint32_t(seed), uint32_t(seed >> 32)}}, counter_{{0, frame, uint32_t(sample), uint32_t(sample >> 32)}} {}

  /// A number that is uniform in [0, 1), with 32 random bits.
  double uniform() {
    if (used_ == 4) {
      block_ = r123::Philox4x32()(counter_, key_);
      ++counter_[0];
      used_ = 0;
    }
    return block_[used_++] * 0x1p-32;
  }

 private:
  r123::Philox4x32::key_type key_;
  r123::Philox4x32::ctr_type counter_;
  r123::Philox4x32::ctr_type block_{};
  size_t used_ = 4;
};

// Splitmix64 (Steele, Lea and Flood, OOPSLA 2014), a generator that adds a step and mixes the sum.

/// 2⁶⁴ over the golden ratio: the step of splitmix64.
inline constexpr uint64_t splitmix_step = 0x9e3779b97f4a7c15;

/// The finalizer of splitmix64: a bijection of 64 bits in which each bit of the result depends on all bits.
constexpr uint64_t mix(uint64_t v) {
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9;
  v = (v ^ (v >> 27)) * 0x94d049bb133111eb;
  return v ^ (v >> 31);
}

}  // namespace holotrace
