#pragma once

#include <cstdint>

#include "holotrace/base/random.h"
#include "holotrace/base/vec.h"

namespace holotrace {

class LowDiscrepancy {
 public:
  LowDiscrepancy(uint64_t seed, uint32_t frame, uint64_t sample) : random_(seed, frame, sample) {}
  void start(uint32_t) {}
  double one() { return random_.uniform(); }
  Vec2 two() {
    const double u = random_.uniform();
    return {u, random_.uniform()};
  }

 private:
  CounterRandom random_;
};

}  // namespace holotrace
