#pragma once

#include <array>

#include "holotrace/base/vec.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/render.h"

namespace holotrace {

/// The places of a viewer's left and right eye: `separation` [m] apart along x, about `eye`.
std::array<Vec3, 2> two_eyes(Vec3 eye, double separation);

/// The parameters of the pictures for the left and the right eye. Both look through the same window in the plane in
/// focus, where a point has the same place in both pictures. A point of depth d lies farther right in the left eye's
/// picture by
///
///     separation·(f − d)/(d + z)   in the plane in focus, for eyes at z and a focus f
///
/// @throws Error  for a separation that is not above 0, and for the panel as a lens, which has no eye
std::array<RenderParams, 2> stereo_pair(const RenderParams& params);

/// Both pictures of a stereo pair in one, for glasses with red before the left eye and cyan before the right. Red is
/// the left picture's luminance, 0.2126·R + 0.7152·G + 0.0722·B (ITU-R BT.709); green and blue are those of the right
/// picture. Red objects then do not flicker between the eyes, and grey stays grey ("half-colour anaglyph"; E. Dubois,
/// Proc. IEEE ICASSP 3, 1661, 2001, compares such methods).
///
/// @param left, right  pictures of one size and number of channels, linear light
/// @return             three channels
/// @throws Error       for pictures of different sizes
Image anaglyph(const Image& left, const Image& right);

}  // namespace holotrace
