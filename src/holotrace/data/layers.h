#pragma once

#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/field.h"

namespace holotrace {

/// A slice of depth, parallel to the panel: the light that leaves its plane, and what the plane hides.
struct Slice {
  Field light;          ///< light on its plane: complex amplitudes [√(W/m²)], on the panel's grid
  Array2D<float> mask;  ///< shape of the light: 0 transmits light from behind, 1 hides it; empty: hides nothing
  double depth() const { return -light.z; }  ///< behind the panel, below 0 in front of it [m]
};

/// Space cut into slices of depth, from the farthest to the one nearest to the viewer (the paper's Fourier methods), on either side of the
/// panel or in it.
struct Layers {
  double wavelength = 0;  ///< wavelength of all slices [m]
  std::vector<Slice> slices;
};

/// @throws Error, naming the first invalid slice, unless there is a slice, all lie from far to near,
///         have the layers' wavelength and one pitch, finite samples, and masks in [0, 1] of the shape of their light.
void check_layers(const Layers& layers);

}  // namespace holotrace
