#pragma once

#include "holotrace/data/scene.h"
#include "holotrace/trace/geometry/accelerator.h"
#include "holotrace/trace/panel_rays.h"

namespace holotrace {

/// A part of the panel as a lens, or of a plane in front of it, and what it accepts.
struct PanelPart {
  double left, right, low, high;  ///< its sides [m]
  double z;                       ///< [m]
  double tangent;                 ///< largest slope of a ray along one axis
  Grid panel;                     ///< the whole panel
  double wavelength;              ///< [m]
};

/// Adds the luminous points of a scene to the picture that a part of the panel has of a plane (focal_stack.h,
/// "Luminous points").
/// @param plane  its distance is that from the lens
void draw_points(const Accelerator& scene, const PanelPart& part, const PixelPlane& plane, Image& picture);

}  // namespace holotrace
