#pragma once

#include "holotrace/data/params/encode.h"

namespace holotrace {

/// Whether a method looks for its levels in iterations that aim at targets (target.h).
inline bool aims_at_targets(Encoding method) {
  return method == Encoding::gerchberg_saxton || method == Encoding::weighted_gerchberg_saxton ||
         method == Encoding::sgd;
}

/// Iterations that a method takes: as many as asked for, or where that is 0 its own number; 0 of methods without.
inline int iterations_of(const EncodeParams& params) {
  if (!aims_at_targets(params.method)) return 0;
  if (params.iterations > 0) return params.iterations;
  return params.method == Encoding::sgd ? sgd_iterations : gerchberg_saxton_iterations;
}

}  // namespace holotrace
