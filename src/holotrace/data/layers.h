#pragma once

#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/field.h"

namespace holotrace {

/// A slice of space parallel to the panel: the light that leaves a plane, and what the plane hides.
struct Slice {
  Field light;          ///< on its plane, z < 0: complex amplitudes [√(W/m²)], its grid on the panel's raster
  Array2D<float> mask;  ///< shape of the light: 0 lets light from behind through, 1 hides it; empty: hides nothing
  double depth() const { return -light.z; }
};

/// Space cut into slices, from the farthest to the nearest (the paper's Fourier methods).
struct Layers {
  double wavelength = 0;  ///< [m]
  std::vector<Slice> slices;
};

/// @throws Error, naming the first slice at fault, unless there is one, all lie behind the panel from far to near, are
///         of the layers' wavelength and one pitch, and have finite samples and masks in [0, 1] of their light's shape.
void check_layers(const Layers& layers);

}  // namespace holotrace
