#pragma once

#include <array>

#include "holotrace/base/observer.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/parameter.h"

namespace holotrace {

/// How a photograph is registered to a simulation.
struct RegisterParams {
  /// Smallest and largest scale to try, in pixels of the photograph per pixel of the simulation. 0: half of the smaller
  /// and twice the larger of 1 and the ratio of the pictures' long sides.
  double smallest_scale = 0, largest_scale = 0;
  bool offset = false;  ///< also fit an offset: stray light or a dark level of the photograph
};

template <class Visitor>
void describe(Visitor&& v, RegisterParams& p) {
  v(number("smallest_scale", p.smallest_scale, range::not_negative,
           "smallest scale to try, in pixels of the photograph per pixel of the simulation; 0: from the "
           "pictures' sizes"));
  v(number("largest_scale", p.largest_scale, range::not_negative, "largest scale to try; 0: from the pictures' sizes"));
  v(flag("offset", p.offset, "also fit a constant brightness of the photograph (stray light or dark level)"));
}

/// How `moving` depicts `fixed`:
///
///     moving(q) = gain·fixed(p) + offset,   q = scale·R(rotation)·p + shift
///
/// p and q are places in pixels from the centre of each picture, x to the right and y up.
struct Registration {
  double scale = 1;                 ///< pixels of `moving` per pixel of `fixed`
  double rotation = 0;              ///< anticlockwise, in (−π, π] [rad]
  double shift_x = 0, shift_y = 0;  ///< place of the centre of `fixed` in `moving` [pixels of moving]
  double gain = 1, offset = 0;
  double correlation = 0;  ///< correlation coefficient of the amplitudes without shading, over the overlap
  double uncertainty = 0;  ///< standard error of a place at the worst corner [pixels of moving]
  double overlap = 0;      ///< fraction of `fixed` that `moving` shows
  double residual = 0;     ///< rms of (moving − offset)/gain − fixed in the overlap [unit of fixed]
  int iterations = 0;      ///< iterations of the last fit

  /// The place in `moving` of a place in `fixed` [pixels from the centre, y up].
  std::array<double, 2> operator()(double x, double y) const;
};

/// Finds the similarity and the gain with which a photograph shows a known picture.
///
/// A search at 48 pixels tries all angles and a range of scales, each with all shifts. Newton's method then refines the
/// best of them at finer and finer resolutions, down to the pixels of the coarser picture, and the resolution with
/// the least standard error is kept. The pictures are compared by amplitude, the root of the mean of an image's
/// channels, without changes slower than a twelfth of the picture; shading and stray light thus do not
/// matter. The gain is the ratio of the light in the overlap. With an offset it is the slope of block means against
/// each other, with the neighbouring blocks as instrument, so that speckle in `fixed` does not lower it.
///
/// @param moving, fixed  pictures of any size from 16 pixels on, finite
/// @throws Error  if no map stands out: too little structure or overlap, or a scale out of range
Registration register_image(const Image& moving, const Image& fixed, const RegisterParams& params = {},
                            const Observer& observer = {});

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
