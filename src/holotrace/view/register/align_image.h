#pragma once

#include "holotrace/data/image.h"
#include "holotrace/view/register/register.h"

namespace holotrace {

/// An upright rectangle of pixels.
struct PixelRectangle {
  int first_row = 0, first_column = 0, rows = 0, columns = 0;
};

/// A photograph brought onto the pixels of a simulation.
struct AlignedImage {
  Image image;             ///< (moving − offset)/gain on the pixels of `fixed`, 0 where `moving` does not reach
  PixelRectangle covered;  ///< the largest one that it fills
};

/// Resamples a photograph by cubic convolution, after a Gaussian of the variance that a pixel of the simulation has
/// more than one of the photograph, (scale² − 1)/12, where it is the larger.
/// @param ny, nx  size of the picture that the registration calls `fixed`
/// @throws Error  if it covers no rectangle of 8 × 8 pixels
AlignedImage align_image(const Image& moving, const Registration& registration, int ny, int nx);

/// The pixels of an upright rectangle.
Image cropped(const Image& image, const PixelRectangle& rectangle);

}  // namespace holotrace
