#pragma once

#include <memory>

#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// The propagator that make_propagator makes of the same arguments, kept for the next who asks: the frames of a job
/// share one for each wavelength and distance. Facts and warnings are told every time. May be called from any thread.
///
/// Those used last are kept, propagator_cache_bytes of them for each precision; one larger than that is not.
/// @throws Error  as make_propagator does
template <class Real>
std::shared_ptr<const Propagator<Real>> cached_propagator(const Grid& grid, double wavelength, double distance,
                                                          const PropagateParams& params, const Observer& observer = {});

/// Bytes of transfer functions that are kept for each precision at most: 512 MiB, or a sixteenth of the memory.
double propagator_cache_bytes();

}  // namespace holotrace
