#pragma once

#include "holotrace/data/image.h"
#include "holotrace/view/register/register.h"

namespace holotrace {

/// An upright rectangle of pixels.
struct PixelRectangle {
  int first_row = 0, first_column = 0, rows = 0, columns = 0;
};

/// A photograph resampled to the pixels of a simulation.
struct AlignedImage {
  Image image;             ///< (moving − offset)/gain on the pixels of `fixed`; 0 beyond `moving`
  PixelRectangle covered;  ///< the largest rectangle that `moving` fills
};

/// Resamples a photograph by cubic convolution. If a pixel of the simulation is larger than one of the photograph, it
/// first applies a Gaussian of the difference of the pixels' variances, (scale² − 1)/12.
/// @param ny, nx  size of the registration's picture `fixed` [pixels]
/// @throws Error  if the photograph covers no rectangle of 8 × 8 pixels
AlignedImage align_image(const Image& moving, const Registration& registration, int ny, int nx);

/// The pixels of an upright rectangle.
Image cropped(const Image& image, const PixelRectangle& rectangle);

}  // namespace holotrace
