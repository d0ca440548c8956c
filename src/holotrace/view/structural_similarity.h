#pragma once

#include "holotrace/data/image.h"

namespace holotrace {

/// Mean structural similarity of s·image and its reference, as defined in view/compare.h. The images have
/// the same size and channels; L > 0 is the maximum of the reference.
double structural_similarity(const Image& reference, const Image& image, double s, double L);

}  // namespace holotrace
