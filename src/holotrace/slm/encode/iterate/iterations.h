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

/// Half width of the stop of a method as a fraction of 1/2p: the one asked for, or the method's default; 1 means none.
inline double stop_width(const EncodeParams& params) {
  if (params.stop > 0) return params.stop;
  return params.method == Encoding::double_phase || params.method == Encoding::error_diffusion ? 0.4 : 1;
}

}  // namespace holotrace
