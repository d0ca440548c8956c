#pragma once

#include "holotrace/data/image.h"

namespace holotrace {

/// Mean structural similarity of s·image and its reference, as view/compare.h defines it. The images have
/// the same size and channels; L > 0 is the range of the reference.
double structural_similarity(const Image& reference, const Image& image, double s, double L);

}  // namespace holotrace
