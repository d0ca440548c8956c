#pragma once

#include <array>

#include "holotrace/base/observer.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/choice.h"

namespace holotrace {

/// How a photograph is laid upon a simulation.
struct RegisterParams {
  /// Pixels of the photograph per pixel of the simulation that are tried. 0: half of the smaller and twice the larger
  /// of 1 and the ratio of the pictures' long sides.
  double smallest_scale = 0, largest_scale = 0;
  bool offset = false;  ///< fit stray light, or a dark level, under the photograph too
};

template <class Visitor>
void describe(Visitor& v, RegisterParams& p) {
  v.number("smallest_scale", p.smallest_scale, range::not_negative,
           "smallest scale to try, in pixels of the photograph per pixel of the simulation; 0: from the "
           "pictures' sizes");
  v.number("largest_scale", p.largest_scale, range::not_negative, "largest scale to try; 0: from the pictures' sizes");
  v.flag("offset", p.offset, "also fit a constant brightness of the photograph (stray light or dark level)");
}

/// How `moving` shows `fixed`:
///
///     moving(q) = gain·fixed(p) + offset,   q = scale·R(rotation)·p + shift
///
/// p and q are places from the centre of each picture in its own pixels, x to the right and y up.
struct Registration {
  double scale = 1;                 ///< pixels of `moving` per pixel of `fixed`
  double rotation = 0;              ///< anticlockwise, in (−π, π] [rad]
  double shift_x = 0, shift_y = 0;  ///< of the centre of `fixed` in `moving` [pixels of moving]
  double gain = 1, offset = 0;
  double correlation = 0;  ///< coefficient of both amplitudes, without their shading, over what they have in common
  double uncertainty = 0;  ///< standard error of a place at the worst corner [pixels of moving]
  double overlap = 0;      ///< part of `fixed` that `moving` shows
  double residual = 0;     ///< rms of (moving − offset)/gain − fixed over it [unit of fixed]
  int iterations = 0;      ///< of the last fit

  /// Where a place of `fixed` is in `moving` [pixels from the centre, y up].
  std::array<double, 2> operator()(double x, double y) const;
};

/// Finds the similarity and the gain by which a photograph shows a known picture.
///
/// A search tries all angles and a range of scales on both pictures at 48 pixels, each with all shifts; Newton's method
/// then refines the best of them, finer from level to level, down to the pixels of the coarser picture, and the level
/// of the least standard error is kept. What is laid upon each other is the amplitude, the root of the mean of an
/// image's channels, less its part that is slower than a twelfth of the picture, so that shading and stray light do not
/// matter. The gain is the ratio of the light that both show; with an offset, it is the slope of block means against
/// each other, with the neighbours as instrument, so that speckle in `fixed` does not lower it.
///
/// @param moving, fixed  of any sizes from 16 pixels on, finite
/// @throws Error  if no such map stands out: too little structure or overlap, or a scale out of range
Registration register_image(const Image& moving, const Image& fixed, const RegisterParams& params = {},
                            const Observer& observer = {});

}  // namespace holotrace
