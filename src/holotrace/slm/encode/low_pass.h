#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/encode.h"

// What the encoders that put their noise at high frequencies share: the stop that keeps it out, the field within it,
// and the modulus that a pixel of 1 stands for.

namespace holotrace {

/// The stop about the axis of half width params.stop/2p along both axes.
/// @throws Error  unless params.stop is in (0, 1]
SpectralFilter low_pass_stop(const EncodeParams& params, const Grid& grid);

/// The field cut to a stop on the axis: what lies beyond would be lost anyway, and would be turned into noise within.
/// Fact: `band_power`, the part of the field's power within.
Field within_stop(const Field& field, const SpectralFilter& stop, const Observer& observer);

/// The field with moduli of at most 1, U/A clipped: A is the modulus that all but `clipped_part` of the pixels have
/// less than, found to 1/4096 of the largest. A smaller A wastes less light on noise, at the cost of what is clipped.
/// Facts: `modulus_max` = A [√(W/m²)], `clipped_part`: the part of the power of U that is cut away.
/// @return A
double normalise_modulus(double clipped_pixels, const Observer& observer, Field& field);

}  // namespace holotrace
