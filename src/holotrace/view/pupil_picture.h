#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "holotrace/base/array.h"
#include "holotrace/base/units.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/image.h"
#include "holotrace/data/light_field.h"
#include "holotrace/data/target.h"

namespace holotrace {

/// The picture that an eye sees through the panel.
struct PupilPicture {
  Image radiance;  ///< mean radiance of the rays of each pixel that pass panel and pupil; black where none does
  Image open;      ///< fraction of the pupil's area that these rays pass, 0 to 1; 1 channel
};

/// The picture in the plane z = −distance that an eye focused on it sees through the panel: shift and add of the
/// pictures of the light field's cells.
///
/// The rays from a point p of the plane to the pupil (centre e, diameter D, at z = e_z) cross the lens (at z = l) in a disc,
/// the pupil's footprint:
///
///     centre p + (e − p)·(d + l)/(d + e_z),   radius (D/2)·(d + l)/(d + e_z)
///
/// A cell's weight is the area of the footprint that lies in it, in the acceptance box |a − p| ≤ (d + l)·T of the pixel, and
/// in the panel as the pixel sees it on the lens. The cell's picture is read where the ray from the cell's centre through p crosses the light field's plane, between
/// the pixels' centres (bilinear); outside its window, the nearest pixel counts. `open` is the sum of the weights over
/// the area of the footprint. The picture is exact, but for the pixels' size, in the light field's own plane for light
/// that is even over a cell. Elsewhere it has the blur of a cell, |d − D|/D times its side for objects at depth D.
///
/// @param light_field  of one or three channels
/// @param wavelength   used for the acceptance [m]
/// @param grid         pixels of the picture
/// @param distance     of the plane from the panel [m], > 0
/// @throws Error       for a pupil that is not in front of the panel, is behind the lens or has no area, a distance that is not above 0,
///                     and a light field whose pictures do not have its own size
///
/// Cost: a few cells per pixel: those that the footprint touches.
PupilPicture picture_through(const LightField& light_field, double wavelength, const Grid& grid, double distance,
                             const Pupil& pupil);

/// Blurs a picture as the diffraction of a pupil of diameter D does, at the distance s from the pupil to the picture, so that it
/// holds no detail that an eye cannot see. Without coherence, the transfer function of radiance is the autocorrelation of the
/// pupil:
///
///     H(ν) = 2/π·(arccos u − u·√(1 − u²)),   u = |ν|·λ·s/D,   0 for u ≥ 1
///
/// The Airy pattern is its point spread function. Values below 0, from rounding, are set to 0.
/// @param picture   any number of channels; changed in place
/// @param pitch     of its pixels [m]
void limit_to_pupil(Image& picture, double pitch, double wavelength, double distance, double diameter);

/// A channel of a picture.
struct PictureChannel {
  Image* picture;
  int channel = 0;

  float& operator()(int row, int column) const { return (*picture)(row, column, channel); }
};

/// The same for many pictures of one size, two at a time.
class PupilBlur {
 public:
  /// @throws Error  as limit_to_pupil does
  PupilBlur(int columns, int rows, double pitch, double wavelength, double distance, double diameter);

  /// @throws Error for pictures of another size
  void apply(std::span<const PictureChannel> pictures) const;

 private:
  int columns_, rows_;
  int left_, top_;           // pixels by which edges are continued
  Array2D<float> transfer_;  // over frequencies, without the length of the transform
};

/// Area of the unit disc where x < u: ∫ 2√(1 − x²) dx from −1 to u, for −1 ≤ u ≤ 1.
inline double disc_area_below(double u) { return pi / 2 + u * std::sqrt((1 - u) * (1 + u)) + std::asin(u); }

/// Area of the unit disc where x < u and y < v, for −1 ≤ u, v ≤ 1. With c = √(1 − v²), the strip at x has the length
/// √(1 − x²) + v for |x| ≤ c; beyond, 2√(1 − x²) for v > 0, and 0 for v < 0.
inline double disc_area_below(double u, double v) {
  const double c = std::sqrt((1 - v) * (1 + v));
  const double end = std::clamp(u, -c, c);
  // ∫ √(1 − x²) dx from −c to end, half of what lies on both sides of the axis
  const double half = (disc_area_below(end) - disc_area_below(-c)) / 2;
  const double inside = half + v * (end + c);
  if (v <= 0) return inside;
  const double left = disc_area_below(std::min(u, -c)), right = u > c ? disc_area_below(u) - disc_area_below(c) : 0.0;
  return left + inside + right;
}

}  // namespace holotrace
