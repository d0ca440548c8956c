#pragma once

#include "holotrace/data/params/encode.h"

namespace holotrace {

/// Whether a method finds its levels by iterations toward targets (target.h).
inline bool aims_at_targets(Encoding method) {
  return method == Encoding::gerchberg_saxton || method == Encoding::weighted_gerchberg_saxton ||
         method == Encoding::sgd;
}

/// Number of iterations of a method: as many as asked for, or for 0 the method's default; 0 for methods without any.
inline int iterations_of(const EncodeParams& params) {
  if (!aims_at_targets(params.method)) return 0;
  if (params.iterations > 0) return params.iterations;
  return params.method == Encoding::sgd ? sgd_iterations : gerchberg_saxton_iterations;
}

}  // namespace holotrace
