#pragma once

#include "holotrace/data/image.h"

namespace holotrace {

/// A picture of where an image is brighter or darker than its reference.
struct DifferenceImage {
  Image image;       ///< three channels of linear light in [0, 1]
  double range = 0;  ///< difference at full colour [unit of the reference]
};

/// The mean over channels of scale·image − reference in colours: grey (sRGB #808080) where they agree, toward
/// vermilion
/// (#D55E00) where the image is brighter and toward blue (#0072B2) where it is darker, in even steps of linear light;
/// colour-blind readers tell these two apart (Okabe and Ito, 2008).
/// @param range   difference at full colour; 0: the largest there is
/// @throws Error  unless sizes and channels agree and the range is not below 0
DifferenceImage difference_image(const Image& reference, const Image& image, double scale, double range = 0);

}  // namespace holotrace
