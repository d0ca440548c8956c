#pragma once

#include <complex>
#include <cstddef>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/propagate.h"

namespace holotrace {

/// |u|² at the samples, shape (ny, nx) [W/m²].
Array2D<float> irradiance_of(const Field& field);

/// |u|² of `count` samples.
void irradiance_of_row(const std::complex<float>* u, size_t count, float* to);

/// The irradiance of the field that `propagate` returns, shape (ny, nx) [W/m²]. For a window of another pitch it takes
/// less time and memory than the field, which it does not hold. A device (PropagateParams::device) sends the irradiance only.
/// @throws Error  as propagate does
Array2D<float> propagate_to_irradiance(const Field& field, double distance, const PropagateParams& params,
                                       const Observer& observer = {});

}  // namespace holotrace
