#pragma once

#include <functional>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/grid.h"

namespace holotrace {

/// The round entrance of an eye or a camera, parallel to the panel and in front of it; light beside it is blocked.
struct Pupil {
  Vec3 centre;          ///< [m], z > 0
  double diameter = 0;  ///< [m]
};

/// The light that a hologram should show in one target plane: the modulus of the field, at any phase and scale.
struct TargetPlane {
  double z = 0;              ///< z of the plane [m]: < 0 behind the panel (virtual image), > 0 in front of it (real)
  double wavelength = 0;     ///< [m]
  Array2D<float> amplitude;  ///< modulus ≥ 0, on the panel's own pixels, shape (ny, nx)
  Array2D<float> weight;     ///< weight ≥ 0 of the squared error, same shape: 0 where any light is allowed; empty: 1
};

/// What eyes should see through one or several pupils, all at one distance from the panel and focused on one plane. The
/// pupils do not overlap.
struct ViewTargets {
  double z = 0;           ///< z of the plane in focus [m]
  double wavelength = 0;  ///< [m]
  Grid window;            ///< samples of the pupils' own plane; its window holds all pupils, on the panel's pitch
  Grid picture;           ///< samples of every picture, in the plane in focus; coarser than the panel's
  std::vector<Pupil> pupils;
  std::vector<Array2D<float>> amplitudes;  ///< modulus ≥ 0 of each picture, shape of `picture`, scaled as the planes'
};

/// Targets of an optimisation, of one or several wavelengths: planes, views, or both.
struct TargetSet {
  std::vector<TargetPlane> planes;  ///< all target planes
  /// Without planes: views that stand for all that are drawn. They are judged, and give the light its scale.
  std::vector<ViewTargets> views{};
  /// Views drawn anew for an update, for one of the wavelengths. Empty: updates use the planes only.
  std::function<ViewTargets(int update, double wavelength)> draw_views{};
  std::vector<Vec3>
      eyes{};  ///< places that the light converges to at the start, frame by frame in turn [m]; may be empty
};

/// The wavelengths of targets, in their order.
std::vector<double> wavelengths_of(const TargetSet& targets);

}  // namespace holotrace
