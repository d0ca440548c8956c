#pragma once

#include "holotrace/base/array.h"
#include "holotrace/data/source_part.h"

namespace holotrace {

/// The image that one part of the light source makes of a point, in the plane at z [m] from a thin panel. Light from a
/// direction that differs by (αx, αy) from the state's own shows the same picture shifted by z·(αx, αy). The irradiance
/// of the whole part is therefore that of the state convolved with this image,
///
///     I(x) = ∫ I₀(x − z·α) d²α / ∫ d²α
///
/// Exact for small angles if only the panel limits the light. A stop or a pupil does not move with the light, so the
/// parts must then be small against its opening. Without a stop the aberration of the shift remains: light
/// that leaves the panel at θ moves by z·α·(1 + 3θ²/2).
///
/// The image is summed over a grid of directions that all parts of the source share. Each is spread linearly over the
/// four samples next to its shift. There are 64·√N or more across the disc of N parts, and 4 or more per sample. An
/// image smaller than a sample keeps its light, and the images of all parts add up to that of the disc exactly.
///
/// @param pitch  pitch of the samples [m]
/// @param reach  R, a number of samples of at least |z|·part.reach()/pitch
/// @return       weights, shape (2R + 1, 2R + 1), row 0 is the top. Their sum is the part's share of the source's area
///               times the number of parts (1 for a whole source), so that parts of equal weight make an even disc
Array2D<float> source_image(const SourcePart& part, double z, double pitch, int reach);

/// values ∗ kernel by FFT, in an array as large as `values`. The result is correct from R samples inside the border
/// on, where 2R + 1 is the side of the kernel.
/// @throws Error  unless the kernel's sides are odd and no larger than those of `values`
Array2D<float> convolved(const Array2D<float>& values, const Array2D<float>& kernel);

/// Bytes that convolved needs beside `values`, for `values` of that size.
double convolved_bytes(int ny, int nx);

}  // namespace holotrace
