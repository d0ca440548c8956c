#pragma once

#include "holotrace/data/grid.h"
#include "holotrace/data/image.h"
#include "holotrace/data/light_field.h"
#include "holotrace/data/pupil.h"

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

}  // namespace holotrace
