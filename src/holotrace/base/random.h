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

}  // namespace holotrace
