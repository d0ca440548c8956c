#pragma once

#include <span>

#include "holotrace/data/image.h"

namespace holotrace {

/// Mean structural similarity of s·image and its reference, as defined in view/compare.h. The images have
/// the same size and channels; L > 0 is the maximum of the reference.
///
/// @param noise  noise of the reference at each of its values, up to a factor of mean square 1; in each window its variance
///               is subtracted from that of the reference. Empty: none
double structural_similarity(const Image& reference, const Image& image, double s, double L,
                             std::span<const float> noise = {});

}  // namespace holotrace
