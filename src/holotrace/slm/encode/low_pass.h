#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/encode.h"

// Shared by the encoders whose noise is at high frequencies: the stop that blocks the noise, the field within the stop,
// and the modulus that a pixel value of 1 stands for.

namespace holotrace {

/// The stop on the axis with half width stop_width(params)/2p along both axes.
SpectralFilter low_pass_stop(const EncodeParams& params, const Grid& grid);

/// The field limited to a stop on the axis. Light beyond the stop would be lost anyway, and would turn into noise
/// within it.
/// Fact: `band_power`, the fraction of the field's power within the stop.
Field within_stop(const Field& field, const SpectralFilter& stop, const Observer& observer);

/// Scales the field to moduli of at most 1: U/A, clipped. All pixels but the fraction `clipped_pixels` have a modulus
/// below A, which is found to 1/4096 of the largest. A smaller A loses less light to noise but clips more.
/// Facts: `modulus_max` = A [√(W/m²)]; `clipped_part`, the fraction of the power of U that is cut off.
/// @return A
double normalise_modulus(double clipped_pixels, const Observer& observer, Field& field);

/// Steps from 0 to the largest modulus in which A is found.
inline constexpr int modulus_steps = 4096;

/// A, by the number of pixels in each of these steps, and last that of the pixels of the largest modulus itself. Fewer than
/// `clipped_pixels` + 1 pixels are above it.
double modulus_to_clip(const std::vector<int64_t>& counts, double largest, double clipped_pixels);

/// Reports the facts of normalise_modulus.
void tell_clipping(double modulus, double clipped_part, const Observer& observer);

}  // namespace holotrace
