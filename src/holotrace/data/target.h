#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "holotrace/base/array.h"
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

/// Targets of an optimisation.
struct TargetSet {
  std::vector<TargetPlane> planes;  ///< all target planes, of one or several wavelengths
  /// The plane that a viewer sees through a pupil, drawn anew for each update, for one of the wavelengths; its scale
  /// is that of the planes. Empty: updates use the planes only.
  std::function<TargetPlane(int update, double wavelength)> draw_view{};
};

}  // namespace holotrace
