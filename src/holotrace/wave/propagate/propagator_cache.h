#pragma once

#include <memory>

#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// The propagator that make_propagator makes of the same arguments, kept for reuse: the frames of a job share one for
/// each wavelength and distance. Facts and warnings are reported on every call. May be called from any thread.
///
/// Keeps the most recently used ones, up to propagator_cache_bytes for each precision. A larger one is not kept.
/// @throws Error  as make_propagator does
template <class Real>
std::shared_ptr<const Propagator<Real>> cached_propagator(const Grid& grid, double wavelength, double distance,
                                                          const PropagateParams& params, const Observer& observer = {});

/// Limit of the transfer functions kept for each precision [bytes]: 512 MiB, or a sixteenth of the memory, unless
/// limit_propagator_cache was called.
double propagator_cache_bytes();

/// Lowers that limit, for programs that use each distance once.
void limit_propagator_cache(double bytes);

}  // namespace holotrace
