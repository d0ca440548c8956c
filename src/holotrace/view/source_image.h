#pragma once

#include "holotrace/base/array.h"
#include "holotrace/data/source_part.h"

namespace holotrace {

/// What a part of the light's source makes of a point in the plane at z [m] from a thin panel: light that comes from
/// the direction (αx, αy) beside the state's own shows the same picture z·(αx, αy) away, so that the irradiance of the
/// whole part is that of the state convolved with the part's picture,
///
///     I(x) = ∫ I₀(x − z·α) d²α / ∫ d²α
///
/// Exact for small angles where nothing but the panel bounds the light. A stop or a pupil does not move with the light:
/// parts are then to be small beside what it lets through. Without a stop the picture's own aberration is left: light
/// that leaves the panel at θ moves by z·α·(1 + 3θ²/2).
///
/// Directions on a grid over the source, which all its parts share, are each spread linearly over the four samples next
/// to where they move light: 64·√N or more across the disc of N parts, and 4 or more per sample. A picture smaller than
/// a sample stays whole, and the pictures of all parts sum to the disc exactly.
///
/// @param pitch  of the samples [m]
/// @param reach  R, samples that hold |z|·part.reach() or more
/// @return       weights, shape (2R + 1, 2R + 1), row 0 is the top; their sum is the part's share of the source's area
///               times the number of parts, so that parts of equal weights make an even disc (1 for a whole source)
Array2D<float> source_image(const SourcePart& part, double z, double pitch, int reach);

/// values ∗ kernel by FFT, in an array as large as `values`; right where the kernel does not reach beyond it, 2R + 1
/// being its side: from R samples inside the border on.
/// @throws Error  unless the kernel's sides are odd and no larger than those of `values`
Array2D<float> convolved(const Array2D<float>& values, const Array2D<float>& kernel);

/// Bytes that convolved takes beside `values`, of that size.
double convolved_bytes(int ny, int nx);

}  // namespace holotrace
