#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/pupil.h"

namespace holotrace {

/// The light that a hologram should show in one target plane: the modulus of the field, at any phase and scale.
struct TargetPlane {
  double z = 0;              ///< z of the plane [m]: < 0 behind the panel (virtual image), > 0 in front of it (real)
  double wavelength = 0;     ///< [m]
  Array2D<float> amplitude;  ///< modulus ≥ 0, on the panel's own pixels, shape (ny, nx)
  Array2D<float> weight;     ///< weight ≥ 0 of the squared error, same shape: 0 where any light is allowed; empty: 1
  std::optional<Pupil> pupil{};  ///< the plane is seen through this pupil only; none: all light that leaves the panel
};

/// What eyes should see through several pupils, all at one distance from the panel and focused on one plane. The
/// pupils do not overlap.
struct ViewTargets {
  double z = 0;           ///< z of the plane in focus [m]
  double wavelength = 0;  ///< [m]
  Grid picture;           ///< samples of every picture, in that plane; coarser than the panel's
  std::vector<Pupil> pupils;
  std::vector<Array2D<float>> amplitudes;  ///< modulus ≥ 0 of each picture, shape of `picture`, scaled as the planes'
};

/// Targets of an optimisation.
struct TargetSet {
  std::vector<TargetPlane> planes;  ///< all target planes, of one or several wavelengths
  /// Views drawn anew for an update, for one of the wavelengths. Empty: updates use the planes only.
  std::function<ViewTargets(int update, double wavelength)> draw_views{};
};

}  // namespace holotrace
