#pragma once

#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/field.h"

namespace holotrace {

/// The first Rayleigh–Sommerfeld integral at any points, summed sample by sample: the slow exact reference that the
/// fast propagators are tested against.
///
///     U(p) = Σ h(p − p′)·u(p′)·pitch²,   h as rayleigh_sommerfeld_kernel
///
/// @param points  points at which to evaluate the field, z relative to the field's plane, of either sign [m]
/// @return        complex amplitude at each point [√(W/m²)]
///
/// Cost: samples × points square roots, sines and cosines.
std::vector<std::complex<double>> sum_rayleigh_sommerfeld(const FieldDouble& field, const std::vector<Vec3>& points);

}  // namespace holotrace
