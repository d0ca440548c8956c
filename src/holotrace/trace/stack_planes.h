#pragma once

#include <optional>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/geometry/accelerator.h"

namespace holotrace {

/// A ray that leaves the panel at `from` and crosses the plane z = −d at from + slope·d [m].
struct PanelRay {
  Vec2 from, slope;

  Vec2 at(double distance) const { return {from.x + slope.x * distance, from.y + slope.y * distance}; }
};

/// Pixels in the plane z = −distance.
struct PixelPlane {
  Grid grid;
  double distance = 0;
};

/// Which rays are traced for pictures in several planes, and with which density (formulas: focal_stack.h).
class PanelRays {
 public:
  /// @param tangent  largest slope of a ray along one axis
  /// @param paths    paths wanted per pixel of each plane
  PanelRays(const Grid& panel, double tangent, const std::vector<PixelPlane>& planes, int paths);

  /// The number of candidates that a pixel of plane j needs, 0 to `paths`: 0 if earlier planes already have all of its
  /// rays with the density that it wants.
  int candidates(int plane, int row, int column) const;

  /// The ray through a place in plane j, in pixels from its upper left corner, from a point of the panel that two
  /// numbers select; none if the panel has no such point.
  std::optional<PanelRay> ray(int plane, Vec2 place, Vec2 numbers) const;

  /// Probability with which one of `candidates` is kept.
  double keep_probability(int plane, const PanelRay& ray, int candidates) const;

  /// 1/ρ of a ray that crosses the window of at least one plane, relative to the first plane's 1/ρ₀.
  double weight(const PanelRay& ray) const;

 private:
  struct Plane {
    PixelPlane pixels;
    double density;  // ρⱼ/ρ₀
    bool is_crossed_at(Vec2 place) const;
  };
  bool is_crossed_by_all(const Plane& plane, const Plane& other, int row, int column) const;
  double density_before(int plane, const PanelRay& ray) const;

  Grid panel_;
  double tangent_;
  int paths_;
  std::vector<Plane> planes_;
};

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
/// @param share  factor of their light
void draw_points(const Accelerator& scene, const PanelPart& part, const PixelPlane& plane, double share,
                 Image& picture);

}  // namespace holotrace
