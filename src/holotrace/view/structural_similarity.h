#pragma once

#include <span>

#include "holotrace/data/image.h"

namespace holotrace {

/// Mean structural similarity of s·image and its reference, as defined in view/compare.h. The images have
/// the same size and channels; L > 0 is the maximum of the reference.
///
/// @param noise  variance of the reference's noise at each of its values, which does not count: it is subtracted from the
///               reference's squares. Empty: none
double structural_similarity(const Image& reference, const Image& image, double s, double L,
                             std::span<const float> noise = {});

}  // namespace holotrace
